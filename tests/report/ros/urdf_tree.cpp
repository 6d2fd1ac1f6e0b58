// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/report/ros/urdf_tree.hpp"

#include <urdf_parser/urdf_parser.h>

#include <stdexcept>

namespace millpose {
namespace {

Eigen::Isometry3d PoseFrom(const urdf::Pose& pose) {
  double x = 0, y = 0, z = 0, w = 1;
  pose.rotation.getQuaternion(x, y, z, w);
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  X.translation() = Eigen::Vector3d(pose.position.x, pose.position.y, pose.position.z);
  return X;
}

ReadShape ShapeFrom(const urdf::Geometry& geometry, const urdf::Pose& origin) {
  ReadShape shape;
  shape.X_LG = PoseFrom(origin);
  if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry)) {
    shape.kind = "box";
    shape.size = Eigen::Vector3d(box->dim.x, box->dim.y, box->dim.z);
  } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry)) {
    shape.kind = "cylinder";
    shape.radius = cylinder->radius, shape.length = cylinder->length;
  } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry)) {
    shape.kind = "sphere";
    shape.radius = sphere->radius;
  } else {
    const auto& mesh = dynamic_cast<const urdf::Mesh&>(geometry);
    shape.kind = "mesh";
    shape.file = mesh.filename;
    if (mesh.scale.x != 1 || mesh.scale.y != 1 || mesh.scale.z != 1)
      throw std::runtime_error("a scaled mesh");
  }
  return shape;
}

}  // namespace

UrdfTree::UrdfTree(const std::string& text) : model_(urdf::parseURDF(text)) {
  if (!model_) throw std::runtime_error("urdfdom refuses it");
}

std::vector<std::string> UrdfTree::Links() const {
  std::vector<std::string> names;
  for (const auto& [name, link] : model_->links_) names.push_back(name);
  return names;
}

std::map<std::string, ReadJoint> UrdfTree::Joints() const {
  std::map<std::string, ReadJoint> joints;
  for (const auto& [name, joint] : model_->joints_) {
    if (joint->type == urdf::Joint::FIXED) continue;
    ReadJoint& read = joints[name];
    read.type = joint->type == urdf::Joint::REVOLUTE    ? "revolute"
                : joint->type == urdf::Joint::PRISMATIC ? "prismatic"
                                                        : "?";
    read.lower = joint->limits->lower, read.upper = joint->limits->upper,
    read.speed = joint->limits->velocity;
  }
  return joints;
}

std::vector<ReadShape> UrdfTree::Collisions(const std::string& link) const {
  std::vector<ReadShape> shapes;
  for (const auto& collision : model_->getLink(link)->collision_array)
    shapes.push_back(ShapeFrom(*collision->geometry, collision->origin));
  return shapes;
}

std::vector<ReadShape> UrdfTree::Visuals(const std::string& link) const {
  std::vector<ReadShape> shapes;
  for (const auto& visual : model_->getLink(link)->visual_array)
    shapes.push_back(ShapeFrom(*visual->geometry, visual->origin));
  return shapes;
}

std::string UrdfTree::Root() const { return model_->getRoot()->name; }

Eigen::Isometry3d UrdfTree::PoseOf(const std::string& link,
                                   const std::map<std::string, double>& joints) const {
  const urdf::LinkConstSharedPtr found = model_->getLink(link);
  if (!found) throw std::runtime_error("no link " + link);
  if (!found->parent_joint) return Eigen::Isometry3d::Identity();
  const urdf::Joint& joint = *found->parent_joint;
  Eigen::Isometry3d X =
      PoseOf(joint.parent_link_name, joints) * PoseFrom(joint.parent_to_joint_origin_transform);
  const auto value = joints.find(joint.name);
  if (joint.type == urdf::Joint::FIXED || value == joints.end()) return X;
  const Eigen::Vector3d axis(joint.axis.x, joint.axis.y, joint.axis.z);
  if (joint.type == urdf::Joint::PRISMATIC) return X * Eigen::Translation3d(value->second * axis);
  return X * Eigen::AngleAxisd(value->second, axis.normalized());
}

}  // namespace millpose
