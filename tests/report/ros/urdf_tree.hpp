// SPDX-License-Identifier: GPL-3.0-or-later
// A URDF as ROS itself reads it (urdfdom), with forward kinematics of its own: no code of millpose.
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace urdf {
class ModelInterface;
}

namespace millpose {

/// What a link collides with, in metres.
struct ReadShape {
  std::string kind;               ///< box, cylinder, sphere, mesh
  Eigen::Vector3d size{0, 0, 0};  ///< box
  double radius = 0, length = 0;  ///< cylinder, sphere
  std::string file;               ///< mesh
  Eigen::Isometry3d X_LG = Eigen::Isometry3d::Identity();
};

struct ReadJoint {
  std::string type;
  double lower = 0, upper = 0, speed = 0;
};

class UrdfTree {
 public:
  /// Throws std::runtime_error for what urdfdom refuses.
  explicit UrdfTree(const std::string& text);

  std::vector<std::string> Links() const;
  /// Those that move, by name.
  std::map<std::string, ReadJoint> Joints() const;
  std::vector<ReadShape> Collisions(const std::string& link) const;
  std::vector<ReadShape> Visuals(const std::string& link) const;
  std::string Root() const;
  /// Of a link in the root, metres; joints that are not named stand at 0.
  Eigen::Isometry3d PoseOf(const std::string& link, const std::map<std::string, double>& joints) const;

 private:
  std::shared_ptr<urdf::ModelInterface> model_;
};

}  // namespace millpose
