// SPDX-License-Identifier: GPL-3.0-or-later
// Settings of a cell and a job as read: plain data in inside units (mm, N, rad, s), every default here and
// only here. The keys of the YAML stand in the field tables of cell_fields.cpp and job_fields.cpp.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/units.hpp"

namespace millpose {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// {xyz_mm, abc_deg}: R = Rz(A)·Ry(B)·Rx(C), as KUKA counts.
struct PoseSettings {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< mm
  Eigen::Vector3d abc = Eigen::Vector3d::Zero();       ///< rad
};

/// A URDF that an arm is derived from (docs/urdf.md).
struct UrdfSettings {
  std::string file;                             ///< empty: none
  std::string base_link, flange_link;           ///< of the URDF
  std::map<std::string, std::string> packages;  ///< folders that package:// names stand for
  double tolerance = 0.01;                      ///< mm, between the file's joints and the closed form
  int line = 0;                                 ///< of the section, for later errors
};

struct ArmSettings {
  std::string name;
  UrdfSettings urdf;
  double d1 = 0, a1 = 0, a2 = 0, d4 = 0, dz = 0, d6 = 0;  ///< mm
  std::array<int, 6> sign{};
  Vector6 offset = Vector6::Zero();                                 ///< rad
  Vector6 lower = Vector6::Zero(), upper = Vector6::Zero();         ///< rad
  Vector6 speed = Vector6::Zero(), acceleration = Vector6::Zero();  ///< rad/s, rad/s²
  std::string limits_source, stiffness_source;
  bool acceleration_assumed = true;
  Vector6 stiffness = Vector6::Zero();  ///< N·mm/rad
};

struct ToolPartSettings {
  std::string name;
  std::string body_class;   ///< cutter | holder | spindle
  double length = 0;        ///< mm
  double diameter = 0;      ///< mm, at the lower end
  double top_diameter = 0;  ///< mm, at the upper end; same as `diameter` unless given
};

struct ToolSettings {
  std::string name;
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();    ///< in F, mm
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< T's z in F, from tip to holder, unit
  Eigen::Vector3d x = Eigen::Vector3d::UnitX();     ///< T's x in F (its part normal to z), unit
  std::string cutter_shape = "flat";
  double cutter_diameter = 0, cutting_length = 0, corner_radius = 0;  ///< mm
  std::vector<ToolPartSettings> stack;
};

/// One shape; which fields hold depends on `kind`.
struct ShapeSettings {
  std::string kind;  ///< box | sphere | cylinder | capsule | cone | convex | mesh
  Eigen::Vector3d size = Eigen::Vector3d::Zero();     ///< box, mm
  double diameter = 0, top_diameter = 0, length = 0;  ///< mm
  std::vector<Eigen::Vector3d> points;                ///< convex, mm
  std::string mesh_file;                              ///< relative to the file that names it
  double unit = 1;                                    ///< mm per unit of the mesh file
};

struct BodySettings {
  std::string name;
  std::string body_class;  ///< link | spindle | holder | cutter | fixture | platform
  std::string mount;       ///< world | base | link1..link6 | tool | workpiece
  ShapeSettings shape;
  PoseSettings pose;
};

/// An output that programs switch on the path, where every cut begins or ends.
struct PathOutputSettings {
  int number = 0;
  std::string at;    ///< cut_begin | cut_end
  bool on = true;    ///< what it is switched to
  double delay = 0;  ///< s after that place; krl
};

struct ControllerSettings {
  std::string tool_axis = "z";   ///< x | y | z | -x | -y | -z: controller's tool frame axis along T's z
  std::string rotation = "rpy";  ///< sinumerik, linuxcnc: rpy | euler
  std::array<int, 6> axis_signs{1, 1, 1, 1, 1, 1};  ///< controller angle = sign · A + offset
  Vector6 axis_offsets = Vector6::Zero();           ///< rad
  std::vector<std::string> axis_names = {"RA1", "RA2", "RA3", "RA4", "RA5", "RA6"};  ///< sinumerik
  std::string coordinates = "joint";               ///< linuxcnc: joint | cartesian
  std::string motion = "lin";                      ///< krl: lin | spline
  int base_number = 0, tool_number = 0;            ///< krl: BASE_DATA, TOOL_DATA; 0: values are written
  std::vector<double> external_axes;               ///< krl: E1, E2, …, mm or degrees, constant
  int ptp_speed_percent = 30;                      ///< krl: of the axes' largest speed, between cuts
  int advance = 5;                                 ///< krl: motions that are computed ahead
  std::optional<double> path_acceleration;         ///< krl: mm/s²; the controller's own where not given
  double orientation_speed = DegToRad(200);        ///< krl: rad/s, as BAS(#INITMOV) sets it
  std::optional<double> orientation_acceleration;  ///< krl: rad/s²; the controller's own where not given
  int max_motions = 1400;
  int max_kbytes = 500;
  std::vector<PathOutputSettings> outputs;
  std::map<std::string, std::string> texts;  ///< templates by event name
};

/// A compliance in series with the joints, at a frame that hangs on a link.
struct ComplianceSettings {
  std::string name;
  std::string mount = "base";  ///< base | link1..link6 (link6 = flange, with what hangs on it)
  PoseSettings pose;           ///< of its frame in the mount's
  Eigen::Vector3d translational = Eigen::Vector3d::Zero();  ///< diagonal, mm/N
  Eigen::Vector3d rotational = Eigen::Vector3d::Zero();     ///< diagonal, rad/(N·mm)
  std::vector<Vector6> matrix;  ///< six rows in place of the diagonals; mm/N, 1/N, 1/N, rad/(N·mm)
};

struct MassSettings {
  std::string name;
  std::string mount = "link6";                       ///< link1..link6
  double mass = 0;                                   ///< kg
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of gravity, in the mount's frame, mm
};

/// What weight bends, against a pose in which the arm was calibrated.
struct GravitySettings {
  Vector6 reference = Vector6::Zero();  ///< rad
  std::vector<MassSettings> masses;
  std::optional<double> counterbalance_torque;  ///< N·mm
  double counterbalance_zero = 0;               ///< inner angle of axis 2 where it gives nothing, rad
};

struct CellSettings {
  std::string file;  ///< as given, for messages
  std::string name;
  ArmSettings arm;
  PoseSettings base_in_world;
  Vector6 home = Vector6::Zero();  ///< rad
  ToolSettings tool;
  std::vector<BodySettings> bodies;
  std::vector<std::pair<std::string, std::string>> excluded_pairs;
  double clearance_free = 10, clearance_cutting = 2;  ///< mm
  std::string stiffness_at = "tool_tip";              ///< tool_tip | flange
  double characteristic_length = 1000;                ///< mm
  std::vector<ComplianceSettings> compliances;        ///< beside the joints
  std::optional<GravitySettings> gravity;
  bool programs_allowed = true;  ///< key `reproduction_only: true` forbids programs
  std::map<std::string, ControllerSettings> controllers;
};

struct HalfSpaceSettings {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< P, mm
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< P; points to what is in
};

struct PolygonSettings {
  std::vector<Eigen::Vector3d> points;                   ///< P, mm
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< P; along it the polygon is projected
};

struct ConnectedSettings {
  Eigen::Vector3d seed = Eigen::Vector3d::Zero();  ///< P, mm
  double crease = DegToRad(20);                    ///< rad
};

/// Conditions of which all given ones must hold.
struct ConditionSettings {
  std::optional<std::array<Eigen::Vector3d, 2>> box;  ///< lower and upper corner, P, mm
  std::optional<HalfSpaceSettings> half_space;
  std::optional<PolygonSettings> polygon;
  std::optional<Eigen::Vector3d> facing;  ///< unit direction, P
  double facing_within = DegToRad(45);    ///< rad
  std::optional<ConnectedSettings> connected;
  std::vector<std::string> step_faces;  ///< of a STEP part: numbers, "#ids" or names; any by default
  double rim_distance = 0;              ///< mm from open rims and from edges to faces that are out
};

struct RegionSettings : ConditionSettings {
  std::vector<ConditionSettings> all, any, none;
};

struct PassEndSettings {
  double overrun = 0;                ///< mm, straight on beyond the ends of open passes
  std::string lead = "none";         ///< none | normal | ramp | arc
  double lead_length = 10;           ///< mm; of an arc its radius
  double ramp_angle = DegToRad(15);  ///< rad
};

struct DepthSettings {
  double total = 0, per_layer = 1, allowance = 0, finishing = 0;  ///< mm
};

/// What happens at points where the cutter would go into the part.
struct GougeSettings {
  std::string action = "skip";  ///< skip | lift | report
  double tolerance = 0.05;      ///< depth that is allowed, mm
};

/// A rotary axis of the machine that a G-code programme was written for.
struct CamRotaryAxisSettings {
  std::string axis;                                      ///< A | B | C
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< P, all rotary axes at 0
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< mm
  std::string carries = "tool";                          ///< tool | workpiece
};

struct ToolpathSettings {
  std::string strategy;  ///< parallel_planes | rings | pad | contours | curve | cam
  RegionSettings region;
  Eigen::Vector3d plane_normal = Eigen::Vector3d::UnitX();     ///< parallel_planes, P
  Eigen::Vector3d axis_point = Eigen::Vector3d::Zero();        ///< rings: a point of the axis, P, mm
  Eigen::Vector3d axis_direction = Eigen::Vector3d::UnitZ();   ///< rings, P
  std::string ring_surface = "auto";                           ///< rings: auto | faces | walls
  std::string ring_path = "closed";                            ///< rings: closed | spiral
  double seam_step = 0;                                        ///< rings: from each to the next, rad
  std::string pad_pattern = "zigzag";                          ///< pad: zigzag | spiral
  Eigen::Vector3d pad_direction = Eigen::Vector3d::UnitX();    ///< pad: of the zigzag's lines, P
  std::optional<double> pad_offset;                            ///< pad: the cutter's radius, mm
  std::vector<Eigen::Vector3d> curve_points;                   ///< curve, P, mm
  Eigen::Vector3d curve_direction = Eigen::Vector3d::UnitZ();  ///< curve, P
  std::string cam_file;                                        ///< cam: relative to the job file
  double cam_contact_distance = 1;                             ///< cam, mm
  std::vector<CamRotaryAxisSettings> cam_rotary_axes;          ///< cam: of G-code
  double stepover = 0;                                         ///< mm
  std::string stepover_on = "planes";  ///< planes | surface: where the step-over is measured
  double scallop = 0;                  ///< mm; above 0 the step-over follows from it, stepover at most
  std::string direction = "zigzag";    ///< zigzag | one_way | climb | conventional
  std::string order = "laid";          ///< laid | travel
  double chord_tolerance = 0.01;       ///< mm
  double spacing = 5;                  ///< largest distance of neighbouring points, mm
  double crease = DegToRad(30);        ///< normals are kept apart across sharper edges, rad
  double normal_smoothing = 0;         ///< length over which normals are averaged, mm
  GougeSettings gouges;
  DepthSettings depth;
  PassEndSettings ends;
  double lead = 0, tilt = 0;                                      ///< rad
  Eigen::Vector3d rotation_reference = Eigen::Vector3d::UnitZ();  ///< W
};

/// A point of the part and where it was measured.
struct TargetSettings {
  Eigen::Vector3d nominal = Eigen::Vector3d::Zero();   ///< P, mm
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();  ///< in `frame`, mm
};

struct WorkpieceSettings {
  std::string mesh_file;
  double unit = 1;  ///< mm per unit of the file: 1, 10, 25.4, 1000
  std::string unit_name = "mm";
  std::string frame = "world";  ///< the pose is given in: world | robot_base
  PoseSettings pose;
  std::vector<TargetSettings> targets;  ///< in place of the pose: best fit
  double max_residual = 0.5;            ///< mm, of the fit at any target
  double weld_tolerance = 1e-4;         ///< mm
  double chord_tolerance = 0.05;        ///< mm, between a STEP part's faces and their triangles
  std::string stock_file;               ///< mesh of the raw part; empty: none
  double stock_unit = 1;                ///< mm per unit of it
  std::optional<double> allowance;      ///< material on the part's surface, mm; else toolpath.depth.total
};

struct GeneticSettings {
  int population = 40, generations = 30, elite = 2, max_evaluations = 2000;
  double crossover_rate = 0.9, mutation_rate = 0.2;
};

/// The paper's own genetic algorithm; it gives none of these numbers.
struct PaperSettings {
  int population = 200, generations = 1500, elite = 10;
  double crossover_rate = 0.3;
  double c_max = 1e-3;    ///< mm/N
  double penalty = 1e-5;  ///< mm/N per squared tolerance
};

/// What the cutter takes off, for the cutting force (docs/process-force.md).
struct CuttingSettings {
  std::string material = "5A06";  ///< of the built-in table, unless kc11 is given
  double kc11 = 0;                ///< N/mm²; 0: from the table
  double mc = 0.25;
  int teeth = 0;
  double depth = 0, width = 0;  ///< axial and radial, mm
  std::string side = "down";    ///< up | down | slot
  double radial_ratio = 0.3, axial_ratio = 0;
};

/// What becomes of a plan's points in programs.
struct ProgramOptionSettings {
  double chord_tolerance = 0.01;            ///< mm; of points that are left out
  double angle_tolerance = DegToRad(0.02);  ///< rad; of points that are left out
  double spacing = 0.5;                     ///< mm, least distance of points
  double dry_run_offset = 0;                ///< mm along the tool axis, away from the part
  double base_shift = 1;                    ///< mm; half the width of the window for $BASE
  double base_turn = DegToRad(0.05);        ///< rad; likewise about X, Y, Z
  std::string date;                         ///< printed in the header where given
};

struct JobSettings {
  std::string file;  ///< as given, for messages
  std::string name;
  std::string cell_file;
  uint64_t seed = 1;
  WorkpieceSettings workpiece;
  ToolpathSettings toolpath;
  double feed = 0;                     ///< mm/s
  std::string feed_policy = "keep";    ///< keep | reduce, where the joints cannot hold the feed
  double approach_feed = 1000.0 / 60;  ///< mm/s, down to the last `approach_slow`
  double approach_slow = 5;            ///< mm before the first point that run at the cutting feed
  double retract_feed = 3000.0 / 60;   ///< mm/s
  double spindle_speed = 0;            ///< rev/s
  std::optional<CuttingSettings> cutting;
  std::string objective = "chen2021";
  std::map<std::string, double> objective_parameters;
  std::string formulation = "freedoms";  ///< freedoms | paper
  GeneticSettings genetic;
  PaperSettings paper;
  double exhaustive_step = DegToRad(0.05);            ///< rad
  std::optional<std::array<Vector6, 2>> task_limits;  ///< lower, upper, rad
  double limit_margin = DegToRad(3);                  ///< rad
  double dexterity_min = 0;
  double wrist_min = 0.05, elbow_min = 0.05, shoulder_min = 50;  ///< 1, 1, mm
  double rotation_step = DegToRad(1);                            ///< rad
  Vector6 max_joint_step = Vector6::Constant(DegToRad(5));       ///< rad
  double motion_weight = 1e-5;                                   ///< objective unit per rad²
  double smoothing_loss = 0.01;                                  ///< share of the objective
  double max_deviation = 0.5;                                    ///< mm, half-way between points
  double overlap = 10;                                           ///< mm, where a pass is split
  double swept_resolution = 0.5;                                 ///< mm
  double retract = 50;                                           ///< mm
  double gap_limit_margin = DegToRad(1);                         ///< rad, to the arm's limits
  int gap_iterations = 20000;
  double gap_speed_share = 0.5;
  std::vector<std::string> programs{"krl", "sinumerik", "linuxcnc"};
  ProgramOptionSettings program_options;
  int programs_line = 0;  ///< of the key, for later errors
};

}  // namespace millpose
