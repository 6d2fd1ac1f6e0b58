// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/ros/cell_urdf.hpp"

#include <cassert>

#include "base/angles.hpp"
#include "base/text.hpp"
#include "machine/collision/body_pairs.hpp"
#include "machine/collision/cutter.hpp"
#include "report/ros/cell_tree.hpp"
#include "report/ros/stl_bytes.hpp"
#include "report/view_mesh.hpp"

namespace millpose {
namespace {

std::string Text(double value) { return ShortestNumber(value + 0.0); }
std::string Text(const Eigen::Vector3d& v) {
  return fmt::format("{} {} {}", Text(v.x()), Text(v.y()), Text(v.z()));
}

/// Where something stands; nothing where that is where its parent does. URDF turns by roll, pitch and yaw:
/// R = Rz(yaw)·Ry(pitch)·Rx(roll).
std::string Origin(const Pose& X) {
  if (X.matrix() == Eigen::Matrix4d::Identity()) return {};
  return fmt::format("<origin xyz=\"{}\" rpy=\"{}\"/>", Text(X.translation() / kMetre),
                     Text(AnglesZyx(X.linear()).reverse()));
}

class UrdfWriter {
 public:
  UrdfWriter(const Cell& cell, const RosNames& names, const std::string& meshes)
      : cell_(cell), names_(names), tree_(cell, names), meshes_(meshes) {}

  CellUrdf Write() {
    Line("<?xml version=\"1.0\"?>");
    Line("<robot name=\"{}\">", names_.cell);
    Line("  <!-- Written by millpose. Efforts, masses and inertias are not known to it. -->");
    for (const CoupledLimit& limit : cell_.arm.coupled_limits) CoupledRemark(limit);
    for (const CellFrame& frame : tree_.frames()) Frame(frame);
    for (size_t i = 0; i < cell_.bodies.size(); ++i) BodyLink(cell_.bodies[i], names_.bodies[i]);
    Line("</robot>");
    return std::move(urdf_);
  }

 private:
  template <class... Args>
  void Line(fmt::format_string<Args...> format, Args&&... args) {
    urdf_.text += fmt::format(format, std::forward<Args>(args)...) + "\n";
  }

  void CoupledRemark(const CoupledLimit& limit) {
    std::string sum;
    for (int i = 0; i < 6; ++i)
      if (limit.factors[i] != 0)
        sum += fmt::format("{}{} {}", sum.empty() ? "" : " + ", Text(limit.factors[i]),
                           names_.joints[static_cast<size_t>(i)]);
    Line("  <!-- Not kept by this description: {} at most {} rad. -->", sum, Text(limit.at_most));
  }

  void Frame(const CellFrame& frame) {
    Line("  <link name=\"{}\"/>", frame.name);
    if (frame.parent < 0) return;
    const std::string& parent = tree_.frames()[static_cast<size_t>(frame.parent)].name;
    if (frame.joint == CellFrame::Joint::kFixed) return Fixed(frame.name, parent, frame.X);
    const bool turns = frame.joint == CellFrame::Joint::kTurns;
    const double unit = turns ? 1 : kMetre;
    Line("  <joint name=\"{}\" type=\"{}\">{}<parent link=\"{}\"/><child link=\"{}\"/>",
         names_.joints[frame.axis_number], turns ? "revolute" : "prismatic", Origin(frame.X), parent,
         frame.name);
    Line("    <axis xyz=\"{}\"/><limit lower=\"{}\" upper=\"{}\" velocity=\"{}\" effort=\"0\"/></joint>",
         Text(frame.axis), Text(frame.lower / unit), Text(frame.upper / unit), Text(frame.speed / unit));
  }

  void Fixed(const std::string& child, const std::string& parent, const Pose& X) {
    Line("  <joint name=\"{}_fixed\" type=\"fixed\">{}<parent link=\"{}\"/><child link=\"{}\"/></joint>",
         child, Origin(X), parent, child);
  }

  void BodyLink(const Body& body, const std::string& name) {
    const auto [frame, X] = tree_.MountOf(body);
    Line("  <link name=\"{}\">", name);
    for (const auto& [origin, geometry] : ShapesOf(body, X, name))
      for (const char* use : {"visual", "collision"})
        Line("    <{0}>{1}<geometry>{2}</geometry></{0}>", use, origin, geometry);
    Line("  </link>");
    Fixed(name, tree_.frames()[frame].name, Pose::Identity());
  }

  using ShapeTexts = std::vector<std::pair<std::string, std::string>>;  // origin, geometry

  ShapeTexts ShapesOf(const Body& body, const Pose& X, const std::string& name) {
    if (const auto* box = std::get_if<Box>(&body.shape))
      return {{Origin(X), fmt::format("<box size=\"{}\"/>", Text(box->size / kMetre))}};
    if (const auto* sphere = std::get_if<Sphere>(&body.shape)) return {{Origin(X), Ball(sphere->radius)}};
    if (const auto* c = std::get_if<Cylinder>(&body.shape)) return {{Origin(X), Rod(c->radius, c->length)}};
    if (const auto* capsule = std::get_if<Capsule>(&body.shape)) return CapsuleTexts(*capsule, X);
    if (const auto* cone = std::get_if<Cone>(&body.shape))
      return MeshTexts(ConvexHull(AroundFrustum(*cone).points), X, name);
    if (const auto* convex = std::get_if<Convex>(&body.shape))
      return MeshTexts(ConvexHull(convex->points), X, name);
    return MeshTexts(std::get<Triangles>(body.shape), X, name);
  }

  static std::string Ball(double radius) {
    return fmt::format("<sphere radius=\"{}\"/>", Text(radius / kMetre));
  }
  static std::string Rod(double radius, double length) {
    return fmt::format("<cylinder radius=\"{}\" length=\"{}\"/>", Text(radius / kMetre),
                       Text(length / kMetre));
  }
  static ShapeTexts CapsuleTexts(const Capsule& capsule, const Pose& X) {
    ShapeTexts texts;
    if (capsule.length > 0) texts.emplace_back(Origin(X), Rod(capsule.radius, capsule.length));
    for (const double end : {-capsule.length / 2, capsule.length / 2})
      texts.emplace_back(Origin(X * Eigen::Translation3d(0, 0, end)), Ball(capsule.radius));
    return texts;
  }

  ShapeTexts MeshTexts(const Triangles& mesh, const Pose& X, const std::string& name) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : mesh.vertices) box.extend(p);
    const Eigen::Vector3d centre = box.isEmpty() ? Eigen::Vector3d::Zero().eval() : box.center();
    const std::string file = name + ".stl";
    urdf_.meshes[file] = StlBytes(mesh, centre, name + ", metres");
    return {
        {Origin(X * Eigen::Translation3d(centre)), fmt::format("<mesh filename=\"{}{}\"/>", meshes_, file)}};
  }

  const Cell& cell_;
  const RosNames& names_;
  CellTree tree_;
  const std::string& meshes_;
  CellUrdf urdf_;
};

}  // namespace

CellUrdf MakeCellUrdf(const Cell& cell, const RosNames& names, const std::string& meshes) {
  assert(!cell.deviations);
  return UrdfWriter(cell, names, meshes).Write();
}

}  // namespace millpose
