// SPDX-License-Identifier: GPL-3.0-or-later
// Settings of a cell as read: plain data in inside units (mm, N, rad, s), every default here and only here.
// The keys of the YAML stand in the field tables (CONTRIBUTING.md says which).
#pragma once

#include <Eigen/Dense>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/pose_settings.hpp"
#include "base/units.hpp"
#include "machine/collision/cell.hpp"
#include "machine/robot/denavit_hartenberg.hpp"
#include "machine/robot/mechanism.hpp"
#include "machine/stiffness/compliance.hpp"
#include "program/post_entry.hpp"

namespace millpose {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// A URDF that an arm is derived from (docs/urdf.md).
struct UrdfSettings {
  std::string file;                             ///< empty: none
  std::string base_link, flange_link;           ///< of the URDF
  std::map<std::string, std::string> packages;  ///< folders that package:// names stand for
  double tolerance = 0.01;                      ///< mm, between the file's joints and the closed form
  int line = 0;                                 ///< of the section, for later errors
};

/// A table after Denavit and Hartenberg that an arm is derived from (docs/urdf.md).
struct DhSettings {
  DhConvention convention = DhConvention::kStandard;
  std::vector<DhRow> rows;  ///< empty: none
  double tolerance = 0.01;  ///< mm, between the table's axes and the closed form
  int line = 0;             ///< of the section, for later errors
};

inline constexpr double kStiffnessUncertainty = 0.1;  ///< of a stiffness, where nobody says it

/// What a gear turns by beside its own axis: factor × the angle of another.
struct GearCoupling {
  int gear = 0, axis = 0;  ///< 1 to 6
  double factor = 0;
};

/// Periodic error of the gears' outputs against their inputs (docs/budget.md).
struct GearErrorSettings {
  Vector6 amplitude = Vector6::Zero();  ///< rad, from the mean to the largest
  Vector6 periods = Vector6::Ones();    ///< in one turn of the output
  std::string source;
};

/// One way in which all frames may still be off together, by its standard deviation.
struct DeviationPattern {
  std::vector<Eigen::Vector3d> shifts, turns;  ///< of the frames 0 to 6; mm, rad
  std::vector<double> factors;                 ///< of the couplings in their order; empty: they are known
};

/// How one arm differs from its sheet (docs/arm-deviations.md, docs/gear-table.md).
struct DeviationSettings {
  std::vector<Eigen::Vector3d> shifts, turns;  ///< of the frames 0 to 6 of LinkFrames(); mm, rad
  std::vector<JointHarmonic> gears;            ///< tables of the transmission error
  std::vector<JointCoupling> couplings;        ///< joints that turn with others
  std::vector<DeviationPattern> patterns;      ///< independent of each other
  std::optional<double> uncertainty;           ///< mm, of the flange's position along any direction, 95 %
  std::string source, date;
};

struct ArmSettings {
  std::string name;
  std::string serial;  ///< of the one arm that `deviations` are of
  std::optional<DeviationSettings> deviations;
  UrdfSettings urdf;
  DhSettings dh;
  ArmFamily family = ArmFamily::kSphericalWrist;
  double d1 = 0, a1 = 0, dy = 0, a2 = 0, d4 = 0, dz = 0, d5 = 0, d6 = 0;  ///< mm
  std::array<int, 6> sign{};
  Vector6 offset = Vector6::Zero();                          ///< rad
  Vector6 lower = Vector6::Zero(), upper = Vector6::Zero();  ///< rad
  std::vector<CoupledLimit> coupled_limits;
  int coupled_line = 0;                                             ///< of the key, for later errors
  Vector6 speed = Vector6::Zero(), acceleration = Vector6::Zero();  ///< rad/s, rad/s²
  std::string limits_source, stiffness_source;
  bool acceleration_assumed = true;
  Vector6 stiffness = Vector6::Zero();  ///< N·mm/rad
  /// Half the width of each joint's stiffness interval, a share of it; zero: nobody says.
  Vector6 stiffness_uncertainty = Vector6::Zero();
  bool absolute_accuracy = false;      ///< the controller takes out what weight bends
  std::optional<Vector6> lost_motion;  ///< between the flanks of each joint's gear, rad; empty: not known
  std::string lost_motion_source;
  std::optional<GearErrorSettings> gear_error;
  std::optional<Vector6> gear_friction;  ///< up to which load friction alone holds an output, N·mm
  std::vector<GearCoupling> gear_couplings;
  // How an arm from a URDF or a table arrived; not of the file.
  std::string joints;               ///< which, from where to where; empty: of no URDF
  std::optional<double> deviation;  ///< mm, of the closed form
};

/// How the gears of the arm count its axes (AxisConvention::matrix()).
Matrix6 GearMatrix(const ArmSettings& arm);

/// A compliance in series with the joints, at a frame that hangs on a link.
struct ComplianceSettings {
  std::string name;
  int link = 0;                                             ///< 0 (base) to 6 (flange, with what hangs on it)
  PoseSettings pose;                                        ///< of its frame in the link's
  Eigen::Vector3d translational = Eigen::Vector3d::Zero();  ///< diagonal, mm/N
  Eigen::Vector3d rotational = Eigen::Vector3d::Zero();     ///< diagonal, rad/(N·mm)
  std::vector<Vector6> matrix;  ///< six rows in place of the diagonals; mm/N, 1/N, 1/N, rad/(N·mm)
};

struct ToolPartSettings {
  std::string name;
  BodyClass body_class = BodyClass::kCutter;  ///< cutter, holder or spindle
  double length = 0;                          ///< mm
  double diameter = 0;                        ///< mm, at the lower end
  double top_diameter = 0;                    ///< mm, at the upper end; same as `diameter` unless given
};

/// Shape of a cutter's tip.
enum class CutterTip : uint8_t { kFlat, kBall, kBull };
inline constexpr EnumWords<CutterTip, 3> kCutterTipWords = {
    {{"flat", CutterTip::kFlat}, {"ball", CutterTip::kBall}, {"bull", CutterTip::kBull}}};

struct ToolSettings {
  std::string name;
  SourceLocation name_place = {};                   ///< in the YAML, for later errors
  std::optional<int> number;                        ///< by which controllers know it
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();    ///< in F, mm
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< T's z in F, from tip to holder, unit
  Eigen::Vector3d x = Eigen::Vector3d::UnitX();     ///< T's x in F (its part normal to z), unit
  CutterTip cutter_tip = CutterTip::kFlat;
  double cutter_diameter = 0, cutting_length = 0, corner_radius = 0;  ///< mm
  bool centre_cutting = false;                                        ///< may go straight down into material
  double max_ramp = DegToRad(3);  ///< rad, of a ramp or helix into material
  std::vector<ToolPartSettings> stack;
  std::optional<ToolLoad> load;
  std::vector<ComplianceSettings> compliances;              ///< beside the cell's, while it is in the spindle
  std::optional<double> tip_uncertainty, axis_uncertainty;  ///< of tip and axis in F, mm and rad
};

/// Radius of the cutter's rounded corner, by its shape, mm.
double CornerRadius(const ToolSettings& tool);

enum class ShapeKind : uint8_t { kBox, kSphere, kCylinder, kCapsule, kCone, kConvex, kMesh };

/// One shape; which fields hold depends on `kind`.
struct ShapeSettings {
  ShapeKind kind = ShapeKind::kBox;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();     ///< box, mm
  double diameter = 0, top_diameter = 0, length = 0;  ///< mm
  std::vector<Eigen::Vector3d> points;                ///< convex, mm
  std::string mesh_file;                              ///< relative to the file that names it
  double unit = 1;                                    ///< mm per unit of the mesh file
};

/// What a body hangs on.
struct MountSettings {
  Mount mount = Mount::kWorld;
  int link = 0;  ///< 0 (base) to 6, where that is a link
  bool operator==(const MountSettings&) const = default;
};

/// The links of the arm by number, the base first.
inline constexpr EnumWords<int, 7> kLinkWords = {
    {{"base", 0}, {"link1", 1}, {"link2", 2}, {"link3", 3}, {"link4", 4}, {"link5", 5}, {"link6", 6}}};

struct BodySettings {
  std::string name;
  BodyClass body_class = BodyClass::kFixture;  ///< all but workpiece and stock
  MountSettings mount;
  std::string axis;  ///< whose carriage it is on, where that is its mount
  ShapeSettings shape;
  PoseSettings pose;
  bool from_urdf = false;  ///< not of the cell file
};

struct MassSettings {
  std::string name;
  int link = 6;
  double mass = 0;                                   ///< kg
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of gravity, in the link's frame, mm
};

/// What weight bends, against a pose in which the arm was calibrated.
struct GravitySettings {
  Vector6 reference = Vector6::Zero();  ///< rad
  std::vector<MassSettings> masses;
  std::optional<double> counterbalance_torque;  ///< N·mm
  double counterbalance_zero = 0;               ///< inner angle of axis 2 where it gives nothing, rad
};

/// An external axis as a cell gives it.
struct ExternalAxisSettings : ExternalAxis {
  std::optional<double> stiffness;  ///< N/mm or N·mm/rad: 1 ÷ compliance
  std::string stiffness_source;
  std::optional<double> lost_motion;  ///< mm or rad; empty: not known
  std::string lost_motion_source;
};

/// Feed where no material of a job's raw part is near (docs/stock.md).
struct AirFeedSettings {
  double feed = 0;          ///< mm/s
  double margin = 5;        ///< mm: what material keeps off the cutter there
  double longer_than = 20;  ///< mm: of way in one go; shorter ones run at the feed of the cut
};

struct CellSettings {
  std::string file;  ///< as given, for messages
  std::string text;  ///< of the file, for the places of later errors
  std::string name;
  ArmSettings arm;
  PoseSettings base_in_world;  ///< of B; as long as no URDF is resolved, what the file says
  PoseSettings stated_base;    ///< what the file, or the job in its place, says: of a URDF its base link
  std::vector<ExternalAxisSettings> external_axes;
  Vector6 home = Vector6::Zero();    ///< rad
  ToolSettings tool;                 ///< that a job takes: one of `tools`, where there are some
  std::vector<ToolSettings> tools;   ///< that the spindle can hold; empty: `tool` alone
  std::string tools_file;            ///< that they stand in, until ResolveTools() read it
  int tools_line = 0;                ///< of that key, for later errors
  std::optional<Vector6> change_at;  ///< where the arm stands while the tool is changed, rad; else home
  std::vector<BodySettings> bodies;
  std::vector<std::pair<std::string, std::string>> excluded_pairs;
  bool auto_excluded_pairs = false;     ///< neighbours that touch in every sampled pose are added to them
  std::vector<std::string> warnings;    ///< of reading the cell's URDF; not written
  int bodies_line = 0;                  ///< of the key, for later errors
  std::vector<int> unchecked_links;     ///< 0 (base) to 5: without a body on purpose
  std::vector<std::string> far_bodies;  ///< farther from their link than the arm is long, on purpose
  double clearance_free = 10, clearance_cutting = 2;  ///< mm
  std::optional<AirFeedSettings> air_feed;
  StiffnessOrigin stiffness_at = StiffnessOrigin::kToolTip;
  double characteristic_length = 1000;          ///< mm
  std::vector<ComplianceSettings> compliances;  ///< beside the joints
  std::optional<GravitySettings> gravity;
  bool programs_allowed = true;  ///< key `reproduction_only: true` forbids programs
  std::map<std::string, ControllerOptions> controllers;
  int controllers_line = 0;        ///< of the key, for later errors
  std::vector<std::string> notes;  ///< what followed from what was read, and is said once
};

/// A tools file: the tools that several cells share (key `millpose_tools: 1`).
struct ToolsFile {
  std::string file;  ///< as given, for messages
  std::vector<ToolSettings> tools;
};

}  // namespace millpose
