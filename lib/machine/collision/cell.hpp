// SPDX-License-Identifier: GPL-3.0-or-later
// The bodies of a cell as plain data; World turns them into FCL objects.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/enum_words.hpp"
#include "geometry/mesh/triangles.hpp"
#include "machine/robot/deviations.hpp"
#include "machine/robot/mechanism.hpp"

namespace millpose {

struct Box {
  Eigen::Vector3d size;
};  ///< mm, centred at the body's frame
struct Sphere {
  double radius;
};  ///< mm
struct Cylinder {
  double radius, length;
};  ///< mm, axis z, centred
struct Capsule {
  double radius, length;
};  ///< mm, axis z, length of the cylindrical part, centred
struct Cone {
  double radius_bottom, radius_top, length;
};  ///< mm, frustum about z, centred; tool stacks
struct Convex {
  std::vector<Eigen::Vector3d> points;
};  ///< convex hull of the points, mm
using Shape = std::variant<Box, Sphere, Cylinder, Capsule, Cone, Convex, Triangles>;

/// Radius of a sphere about the shape's frame that holds it, mm.
double Radius(const Shape& shape);

/// What a body is; decides which pairs are checked and with which clearance. The stock is the raw part, of
/// which the workpiece is what will be left.
enum class BodyClass : uint8_t { kLink, kSpindle, kHolder, kCutter, kFixture, kPlatform, kWorkpiece, kStock };
inline constexpr EnumWords<BodyClass, 8> kBodyClassWords = {{{"link", BodyClass::kLink},
                                                             {"spindle", BodyClass::kSpindle},
                                                             {"holder", BodyClass::kHolder},
                                                             {"cutter", BodyClass::kCutter},
                                                             {"fixture", BodyClass::kFixture},
                                                             {"platform", BodyClass::kPlatform},
                                                             {"workpiece", BodyClass::kWorkpiece},
                                                             {"stock", BodyClass::kStock}}};

/// What a body hangs on: the world W, the arm's link frames 0..6 (kinematics.hpp), the tool T, the
/// workpiece P, or what an external axis carries (frame W, with all external axes at 0).
enum class Mount : uint8_t { kWorld, kLink, kTool, kWorkpiece, kCarriage };

struct Body {
  std::string name;
  BodyClass body_class = BodyClass::kFixture;
  Mount mount = Mount::kWorld;
  int link = 0;                  ///< 0..6 when mounted on a link
  Pose X_MG = Pose::Identity();  ///< the shape's frame G in the frame M that it is mounted on
  Shape shape;
  int axis = 0;  ///< of Cell::external_axes, when mounted on what it carries
};

/// Distances to keep, mm.
struct Clearances {
  double free = 10;    ///< everything, while the tool is out of the material
  double cutting = 2;  ///< spindle and holder against the workpiece while cutting
};

/// A robot cell: the arm in its place, the tool, and all bodies.
struct Cell {
  std::string name;
  Arm arm;
  std::vector<ExternalAxis> external_axes;
  ExternalPosition external;     ///< where the external axes stand; empty: all at 0
  Pose X_WB = Pose::Identity();  ///< with the external axes at `external`, as all poses in W
  Pose X_FT = Pose::Identity();  ///< tool tip in the flange; T's z from tip to holder
  Pose X_WP = Pose::Identity();  ///< the workpiece of the job
  std::vector<Body> bodies;      ///< the workpiece among them
  std::vector<std::pair<std::string, std::string>>
      excluded_pairs;    ///< by body name, declared in the cell YAML
  double allowance = 0;  ///< material on the workpiece's surface, mm: added to every clearance from it
  double cutter_length =
      0;  ///< cutting length from the tip, mm: the part of the cutter that may touch while cutting
  Clearances clearances;
  Joints home = Joints::Zero();
  /// Where the arm is taken as it is (AsItIs), how it differs from `arm`.
  std::optional<ArmDeviations> deviations;
};

/// The same cell with the arm as it is: bodies of the links hang where they really do. `arm` and `X_FT` stay
/// those that the controller computes with. Precondition: `cell` has no deviations yet.
Cell AsItIs(Cell cell, const ArmDeviations& deviations);

/// The frames that bodies hang on, in B: LinkFrames(), or TrueLinkFrames() where the arm is taken as it is;
/// its controller has the joints at `q`.
LinkPoses FramesOf(const Cell& cell, const Joints& q);
/// By how much its joints turn at most while the controller turns them by at most `turn`, rad, ≥ 0.
Joints MostTurnOf(const Cell& cell, const Joints& turn);
/// The tool in the last of them.
Pose ToolOnFlange(const Cell& cell);

}  // namespace millpose
