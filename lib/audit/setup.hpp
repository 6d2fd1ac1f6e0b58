// SPDX-License-Identifier: GPL-3.0-or-later
// What the judge knows of a cell and a job. Nothing here is shared with the planner's own modules: poses,
// shapes and verdicts are computed anew, so that a mistake there is not repeated here.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace millpose::audit {

using Real = long double;
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Matrix3 = Eigen::Matrix<Real, 3, 3>;
using Matrix4 = Eigen::Matrix<Real, 4, 4>;
using Angles = std::array<Real, 6>;  ///< joint angles A1..A6, rad, as the arm's maker counts them

/// A closed or open surface: corners of triangles, mm.
using Mesh = std::vector<std::array<Vector3, 3>>;

/// One solid of the cell, tessellated from inside (its corners lie on the true surface).
struct Body {
  std::string name, kind;  ///< kind: link, spindle, holder, cutter, fixture, platform, workpiece, stock
  int link = -1;           ///< 0 (base) .. 6 (flange, tool): moves with that frame; -1 stands in the world
  bool in_cut = false;     ///< part of the cutter within the cutting length: may touch the workpiece in a cut
  Matrix4 X_LG;            ///< shape in its link's frame, or in the world
  Mesh mesh;               ///< in the shape's frame
  int carrier = -1;        ///< of what stands in the world: the external axis that it moves with
  bool guided = false;     ///< the carriage of an external axis, which meets the next one in a joint
};

/// The joints of a URDF from base to flange as that file has them, one after the other.
struct UrdfArm {
  struct Joint {
    Matrix4 origin;
    Vector3 axis;  ///< of a joint that turns; zero: fixed
  };
  std::vector<Joint> joints;
  Matrix4 X_WS, X_ET;  ///< the base link in W, the tool in the flange link, as the cell states them
};

/// A spring beside the joints: it gives way by C·wrench, both in its own frame.
struct Spring {
  int link = 0;  ///< 0 (base) .. 6 (flange)
  Matrix4 X_LK;
  Eigen::Matrix<Real, 6, 6> C;  ///< mm/N, 1/N, 1/N, rad/(N·mm)
};

/// A rail, lift or table.
struct ExternalAxis {
  std::string name;
  bool rotary = false, carries_robot = false;
  Vector3 direction, origin;       ///< in the world, with all of them at 0; mm
  Real lower, upper, home, speed;  ///< mm or rad, and per s
  Real compliance = 0;             ///< mm/N, or rad/(N·mm)
};

/// What a controller calls an external axis, and whether its own kinematics count in it.
struct ControllerAxis {
  std::string name;
  size_t axis;  ///< of Setup::axes
  bool coupled;
};

/// The rail that a KRL controller counts in, in its $WORLD.
struct KrlRail {
  Matrix4 root;       ///< $ERSYSROOT
  Vector3 direction;  ///< of the carriage, in it
};

/// The cell and job as far as the laws need them.
struct Setup {
  Real d1, a1, a2, d4, dz, d6;        ///< mm
  Real dy = 0, d5 = 0;                ///< mm
  bool parallel = false;              ///< axes 2, 3 and 4 are; else the wrist is spherical
  Angles sign, offset, lower, upper;  ///< 1, rad
  Angles hard_lower, hard_upper;      ///< the arm's own limits, rad
  /// Σ factors·angles ≤ at_most (rad), without the job's margin.
  struct Coupled {
    Angles factors;
    Real at_most;
  };
  std::vector<Coupled> coupled;
  Real coupled_margin = 0;            ///< rad, that points keep from them
  Angles stiffness;                   ///< N·mm/rad
  Angles max_step;                    ///< rad, infinite where the job has none
  Angles max_step_speed;              ///< rad/s: the job's share of the arm's
  Real max_step_per_mm = 0;           ///< rad
  Angles home;                        ///< rad
  Real characteristic_length = 1000;  ///< mm
  bool stiffness_at_flange = false;
  std::vector<Spring> springs;
  Matrix4 X_WB, X_FT, X_WP;
  /// By how much each of Frames() stands elsewhere, in its own axes; identities where the arm is its sheet's.
  std::array<Matrix4, 7> deviations = {Matrix4::Identity(), Matrix4::Identity(), Matrix4::Identity(),
                                       Matrix4::Identity(), Matrix4::Identity(), Matrix4::Identity(),
                                       Matrix4::Identity()};
  /// By how much joint `joint` is ahead of the controller's angle a: amplitude · sin(count · a + phase), rad.
  struct Wave {
    size_t joint;
    Real count, amplitude, phase;
  };
  /// Joint `joint` turns beside its own angle by factor times that of `by`.
  struct Follower {
    size_t joint, by;
    Real factor;
  };
  std::vector<Wave> waves;
  std::vector<Follower> followers;
  std::vector<ExternalAxis> axes;  ///< all at 0, as what stands in the world; each carries the later ones
  Real w1 = 0, w2 = 0;             ///< of objective chen2021; both 0 for others
  Real spacing = 0;                ///< mm
  bool rings = false;              ///< passes may be closed
  bool laid = true;  ///< cut points lie on the workpiece or a layer over it: no hole, no trimmed edge
  std::string urscript_tool_axis = "z";
  std::string krl_tool_axis = "z", sinumerik_tool_axis = "z", sinumerik_rotation = "orirpy";
  std::vector<std::string> sinumerik_words = {"A", "B", "C"};       ///< of the angles
  std::string krl_tool_direction = "x";                             ///< $TOOL_DIRECTION
  bool sinumerik_turn_known = false;                                ///< the cell says how MD21104 stands
  std::string linuxcnc_tool_axis = "z", linuxcnc_rotation = "rpy";  ///< of tool poses
  std::string fanuc_tool_axis = "z";
  Real fanuc_height = 0;  ///< mm, of the controller's world above the robot's base
  std::map<std::string, std::vector<ControllerAxis>> controller_axes;  ///< by controller
  /// How a controller counts: its angle = sign · the arm's + offset (rad), then for each axis `coupling`
  /// times all six on top.
  struct Count {
    std::array<Angles, 6> coupling{};
    Angles sign, offset;
  };
  std::map<std::string, Count> counts;  ///< by controller; those that are not here count as the arm does
  std::optional<KrlRail> krl_rail;
  Matrix4 krl_robot = Matrix4::Identity();  ///< $ROBROOT: the robot in $WORLD, or on the carriage of krl_rail
  std::optional<Matrix4> krl_table;  ///< what $BASE = EK(…) counts from with the table at 0, in $WORLD
  std::vector<Body> bodies;          ///< the workpiece last
  std::vector<std::pair<std::string, std::string>> excluded_pairs;
  std::optional<UrdfArm> urdf;                      ///< of a cell that names one
  Real clearance_free = 10, clearance_cutting = 2;  ///< mm
  Real allowance = 0;                               ///< on the workpiece, added to clearances from it
};

/// By what motion in the world the thing that axis `last` carries has moved, with the axes at `position` (mm
/// or rad, one for each).
Matrix4 Carried(const Setup& setup, int last, const std::vector<Real>& position);
/// The last axis that carries the robot, or the part; -1 where there is none.
int LastCarrier(const Setup& setup, bool robot);
/// The setup with the external axes at `position` instead of 0; what they yield is then a spring of the base.
/// The same setup where `position` is empty.
Setup At(const Setup& setup, const std::vector<Real>& position);

/// Rz(A)·Ry(B)·Rx(C) and a translation; angles in degrees, as KUKA writes frames.
Matrix4 FrameXyzAbc(Real x, Real y, Real z, Real a_deg, Real b_deg, Real c_deg);
Matrix4 Turn(int axis, Real angle);
Matrix4 Shift(Real x, Real y, Real z);

/// Frames of the base and of links 1..6 in W where the controller has the joints at `angles`, by multiplying
/// elementary matrices.
std::array<Matrix4, 7> Frames(const Setup& setup, const Angles& angles);

inline constexpr Real kDegree = 3.14159265358979323846264338327950288L / 180;

}  // namespace millpose::audit
