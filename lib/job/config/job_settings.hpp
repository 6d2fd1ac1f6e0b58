// SPDX-License-Identifier: GPL-3.0-or-later
// Settings of a job as read: plain data in inside units (mm, N, rad, s), every default here and only here.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "geometry/registration/bending.hpp"
#include "job/config/cell_settings.hpp"
#include "job/config/placement_settings.hpp"
#include "job/config/toolpath_settings.hpp"
#include "planning/compensation/compensate.hpp"
#include "planning/links/link_move_planner.hpp"
#include "planning/pass/pass_planner.hpp"
#include "toolpath/engagement/process_force.hpp"

namespace millpose {

/// A point of the part and where it was measured.
struct TargetSettings {
  Eigen::Vector3d nominal = Eigen::Vector3d::Zero();   ///< P, mm
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();  ///< in `frame`, mm
};

/// How the part is bent that `millpose register` found bent.
struct BendingSettings {
  PartBending shape;
  /// The covariance's further rows, a mode each, up to the diagonal one after the other: mm², with turns
  /// mm·rad.
  std::vector<double> covariance;
};

/// How sure the pose is that `millpose register` found (docs/registration.md).
struct RegisteredSettings {
  PoseSettings pose;                                 ///< that it belongs to: the workpiece's
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< P, mm: what the part may be turned about
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< of shift (mm) and turn (rad) in P, as Registration has it
  std::optional<BendingSettings> bending;

  /// Of shift, turn and modes.
  ProbeMatrix WholeCovariance() const {
    const int modes = bending ? static_cast<int>(bending->shape.modes.size()) : 0;
    ProbeMatrix whole = ProbeMatrix::Zero(6 + modes, 6 + modes);
    whole.topLeftCorner<6, 6>() = covariance;
    size_t next = 0;
    for (int i = 6; i < 6 + modes; ++i)
      for (int j = 0; j <= i; ++j) whole(i, j) = whole(j, i) = bending->covariance.at(next++);
    return whole;
  }
};

/// What the workpiece's pose or measured points are given in.
enum class GivenFrame : uint8_t { kWorld, kRobotBase };

/// Raw parts that need no file, in P.
struct StockBox {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero(), upper = Eigen::Vector3d::Zero();  ///< corners, mm
};
struct StockCylinder {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of its first end, mm
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   ///< from there to the other, unit
  double radius = 0, length = 0;                     ///< mm
};

/// What holds the part, beside what stands in the cell.
struct FixtureSettings {
  std::string name;
  Mount mount = Mount::kWorkpiece;  ///< or kWorld
  ShapeSettings shape;
  PoseSettings pose;  ///< in P or W
};

struct WorkpieceSettings {
  std::string mesh_file;
  double unit = 1;  ///< mm per unit of the file: 1, 10, 25.4, 1000
  GivenFrame frame = GivenFrame::kWorld;
  PoseSettings pose;
  std::vector<TargetSettings> targets;           ///< in place of the pose: best fit
  double max_residual = 0.5;                     ///< mm, of the fit at any target
  std::optional<double> registration_tolerance;  ///< mm, by which the milled face may be off (95 %)
  std::optional<double> max_bending;             ///< mm, that clamps may bend the part by; 0: it is rigid
  std::optional<RegisteredSettings> registered;  ///< how sure `pose` is
  double weld_tolerance = 1e-4;                  ///< mm
  bool flip = false;                             ///< open sheets the other way round
  double chord_tolerance = 0.05;                 ///< mm, between a STEP part's faces and their triangles
  int step_seconds = 120;                        ///< of processor time for reading a STEP part
  int step_memory = 2048;                        ///< MB, likewise
  std::string stock_file;                        ///< mesh of the raw part; empty: none
  double stock_unit = 1;                         ///< mm per unit of it
  std::optional<StockBox> stock_box;             ///< in its place
  std::optional<StockCylinder> stock_cylinder;   ///< likewise
  double stock_resolution = 0.5;                 ///< mm, between the lines on which material stands
  std::optional<double> allowance;  ///< material on the part's surface, mm; else toolpath.depth.total
  std::vector<FixtureSettings> fixtures;

  bool HasStock() const { return !stock_file.empty() || stock_box || stock_cylinder; }
};

/// What the cutter takes off, for the cutting force (docs/process-force.md).
struct CuttingSettings {
  std::string material = "5A06";  ///< of the built-in table, unless kc11 is given
  double kc11 = 0;                ///< N/mm²; 0: from the table
  std::string kc11_source;        ///< where it comes from, for reports
  double mc = 0.25;
  int teeth = 0;
  std::optional<double> depth;      ///< axial, mm; else that of the layers
  std::optional<double> width;      ///< radial, mm; else the step-over
  std::optional<MillingSide> side;  ///< else from path and stock
  double radial_ratio = 0.3, axial_ratio = 0;
};

/// What computed forces are multiplied by, by the side of the cut.
struct ForceFactors {
  double up = 1, down = 1, slot = 1;
  bool operator==(const ForceFactors&) const = default;
};

/// How long an external axis stays where it is: for the job, for each pass, or, kContinuous, not even along a
/// pass.
enum class ExternalScope : uint8_t { kConstant, kPerPass, kContinuous };
inline constexpr EnumWords<ExternalScope, 3> kExternalScopeWords = {
    {{"constant", ExternalScope::kConstant},
     {"per_pass", ExternalScope::kPerPass},
     {"continuous", ExternalScope::kContinuous}}};

/// Where an external axis of the cell stands; those without an entry stand at home.
struct ExternalSettings {
  std::string axis;  ///< its name
  ExternalScope scope = ExternalScope::kConstant;
  std::optional<double> at_mm, at_deg;      ///< mm, rad; none: the planner chooses
  std::optional<double> step_mm, step_deg;  ///< mm, rad, between positions that it chooses from
};

/// What of the deflection programs take out (docs/compensation.md).
struct CompensationSettings {
  TakeOut deflection = TakeOut::kOff;
  std::optional<double> shrink;                 ///< share that is taken out; else by what is sure
  std::optional<double> stiffness_uncertainty;  ///< share; else the cell's, or kStiffnessUncertainty
  double most = 0.1;                            ///< mm
  CompensatedLayers layers = CompensatedLayers::kFinished;
  bool weight = false;
  std::string map_file;       ///< of a measured part's error; empty: none
  bool deviations = false;    ///< of the arm's frames and joints
  double most_deviation = 5;  ///< mm, that those of the frames may move the tip by
  double most_gear = 2;       ///< mm, that the law of its joints may move it by

  /// Whether tips are shifted from where the plan has them.
  bool Shifts() const { return deflection != TakeOut::kOff || weight || !map_file.empty(); }
  bool IsOn() const { return Shifts() || deviations; }
};

/// What becomes of a plan's points in programs.
struct ProgramOptionSettings {
  double path_tolerance = 0.02;           ///< mm; how far a program may take the tip off the plan's path
  double path_angle = DegToRad(0.02);     ///< rad; likewise the tool's orientation
  std::optional<double> chord_tolerance;  ///< mm, of points that are left out; half of path_tolerance
  std::optional<double> angle_tolerance;  ///< rad, likewise; 0.8 of path_angle
  double spacing = 0.5;                   ///< mm, least distance of points
  double dry_run_offset = 0;              ///< mm along the tool axis, away from the part
  double base_shift = 1;                  ///< mm; half the width of the window for $BASE
  double base_turn = DegToRad(0.05);      ///< rad; likewise about X, Y, Z
  std::string date;                       ///< printed in the header where given
};

/// What is done where the joints cannot hold the feed.
enum class FeedPolicy : uint8_t { kKeep, kReduce };

/// What `cutting` finds standing before the first pass.
enum class Standing : uint8_t { kRegion, kMesh };

/// What the genetic algorithm varies.
enum class Formulation : uint8_t { kFreedoms, kPaper };

/// What becomes of passes where material stands that should be gone.
enum class OverMissing : uint8_t { kLeaveOut, kCut };

struct JobSettings {
  std::string file;  ///< as given, for messages
  std::string name;
  std::string cell_file;
  std::string tool;                           ///< which of the cell's; empty: its only one
  std::optional<PoseSettings> base_in_world;  ///< of the robot; none: the cell's
  std::string operation;                      ///< of a job that has several, which this one is; else empty
  std::string operation_of;                   ///< the name of that job
  bool tool_held = false;                     ///< the operation before leaves this tool in the spindle
  uint64_t seed = 1;
  WorkpieceSettings workpiece;
  ToolpathSettings toolpath;
  double feed = 0;  ///< mm/s
  FeedPolicy feed_policy = FeedPolicy::kReduce;
  double min_feed_share = 0.5;         ///< of the programmed feed: less is a finding
  std::optional<double> plunge_feed;   ///< mm/s, of every motion towards material; else the cutting feed
  double approach_feed = 1000.0 / 60;  ///< mm/s, down to the last `approach_slow`
  double approach_slow = 5;            ///< mm before the first point that run at the plunge feed
  double retract_feed = 3000.0 / 60;   ///< mm/s
  double spindle_speed = 0;            ///< rev/s
  std::optional<CuttingSettings> cutting;
  Standing stock = Standing::kRegion;
  ForceFactors force_factors;
  std::string force_file;                 ///< of measured forces; empty: none
  double force_uncertainty_percent = 30;  ///< by how much the force may exceed the computed one
  double force_direction_deg = 20;        ///< how far off its direction it may lie, degrees
  std::string objective = "chen2021";     ///< surface_error where `cutting` is given and no objective
  bool objective_open = false;            ///< none was named, and `cutting` is given: the cell decides
  std::map<std::string, double> objective_parameters;
  Formulation formulation = Formulation::kFreedoms;
  PathOptions path;                         ///< but for what other sections say, see MakePathOptions()
  double exhaustive_step = DegToRad(0.05);  ///< rad, of the grid that --audit judges the genetic algorithm by
  PaperFormulationOptions paper;            ///< of formulation paper
  std::optional<std::array<Vector6, 2>> task_limits;  ///< lower, upper, rad
  double limit_margin = DegToRad(3);                  ///< rad
  double dexterity_min = 0;
  double wrist_min = 0.05, elbow_min = 0.05, shoulder_min = 50;  ///< 1, 1, mm
  double swept_resolution = 0.5;                                 ///< mm
  std::optional<bool> worst_first;  ///< whether the worst point comes before the sum; else by the objective
  OverMissing over_missing = OverMissing::kLeaveOut;
  LinkMoveOptions gaps;  ///< but for what other sections say, see MakeLinkMoveOptions()
  std::vector<std::string> programs{"krl", "sinumerik", "linuxcnc"};
  ProgramOptionSettings program_options;
  CompensationSettings compensation;
  std::vector<ExternalSettings> external;
  std::optional<PlacementSettings> placement;  ///< for `millpose place` alone
  int programs_line = 0;                       ///< of the key, for later errors
};

}  // namespace millpose
