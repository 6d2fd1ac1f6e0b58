// SPDX-License-Identifier: GPL-3.0-or-later
// Settings of a job's `toolpath:` as read; inside units, every default here and only here.
#pragma once

#include <Eigen/Dense>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/units.hpp"

namespace millpose {

struct BoxSettings {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero(), upper = Eigen::Vector3d::Zero();  ///< P, mm
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
  std::optional<BoxSettings> box;
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
  std::optional<bool> cam_tip_programming;                     ///< cam: of G-code, at its beginning
  std::map<std::string, std::string> cam_kinematics_codes;     ///< cam: "M428" to tip | joints
  std::string cam_circle = "both";                             ///< cam: of APT, both | tangent | axis
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

}  // namespace millpose
