// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "machine/robot/arm.hpp"

namespace millpose {

/// The bytes of a file by the name (a path) that a xacro file includes it by.
using XacroInclude = std::function<std::string(const std::string&)>;

/// One collision shape of a URDF link, in mm.
struct UrdfShape {
  enum class Kind : uint8_t { kBox, kCylinder, kSphere, kMesh };
  Kind kind = Kind::kBox;
  int line = 0;                                     ///< of the element, for messages
  std::string name;                                 ///< may be empty
  Pose X_LG = Pose::Identity();                     ///< the shape in its link
  Eigen::Vector3d size = Eigen::Vector3d::Zero();   ///< box, mm
  double radius = 0, length = 0;                    ///< cylinder (about z, centred) and sphere, mm
  std::string mesh_file;                            ///< as written: a path, package:// or file://
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  ///< of a mesh, whose coordinates are metres
};

struct UrdfLink {
  std::string name;
  int line = 0;
  std::vector<UrdfShape> collisions;
};

struct UrdfJoint {
  enum class Type : uint8_t { kFixed, kRevolute, kContinuous, kOther };
  std::string name, parent, child;
  int line = 0;
  Type type = Type::kFixed;
  Pose X_PC = Pose::Identity();                     ///< the child in the parent at joint value 0, mm
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< in the child, unit; of a joint that moves
  double lower = 0, upper = 0;                      ///< rad; of a revolute joint
  double speed = 0;                                 ///< rad/s; 0: not given
  bool mimic = false;                               ///< follows another joint
  std::string rounded_angle = {};  ///< an angle of X_PC as written that is a right angle, and rounded too far
};

/// What a URDF says of links, joints and collision geometry. Visuals, inertias and transmissions are left.
struct UrdfModel {
  std::string file;  ///< for messages
  std::string name;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
  std::vector<std::string> notes;  ///< what was taken for something else than it says: right angles
};

/// Right angles that were written with few digits are meant as such where they are off by at most this,
/// rad: 1.571 is off by 2.04e-4.
inline constexpr double kRightAngleWithin = 2.1e-4;

/// Reads a URDF (http://wiki.ros.org/urdf/XML), metres and radians. Throws InputError with every problem
/// found, with its line. Angles of joints that are right angles rounded to few digits are snapped, with a
/// note; one that is rounded further (3.141, 1.57) is left as written and named in its joint. Not XML,
/// missing or malformed attributes, names given twice or that name nothing.
///
/// A xacro file is expanded first as far as that needs no evaluation (docs/urdf.md): `include` gives the
/// bytes of a file that it names, relative to the one that it stands in; places have no line then.
UrdfModel ReadUrdf(std::string_view bytes, const std::string& file, const XacroInclude& include = {});

}  // namespace millpose
