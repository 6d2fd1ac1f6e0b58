// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/ros/cell_urdf.hpp"

#include <cassert>

#include "base/angles.hpp"
#include "base/text.hpp"
#include "machine/collision/body_pairs.hpp"
#include "machine/collision/cutter.hpp"
#include "machine/robot/kinematics.hpp"
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

/// A joint's `lower`, `upper` and `speed` in URDF's units.
struct JointLimits {
  double lower = 0, upper = 0, speed = 0;
};

class UrdfWriter {
 public:
  UrdfWriter(const Cell& cell, const RosNames& names, const std::string& meshes)
      : cell_(cell), names_(names), meshes_(meshes) {}

  CellUrdf Write() {
    Line("<?xml version=\"1.0\"?>");
    Line("<robot name=\"{}\">", names_.cell);
    Line("  <!-- Written by millpose. Efforts, masses and inertias are not known to it. -->");
    for (const CoupledLimit& limit : cell_.arm.coupled_limits) CoupledRemark(limit);
    Frame(kRosWorld);
    Axes(Carries::kRobot);
    Axes(Carries::kWorkpiece);
    Frame(kRosBase);
    Fixed(kRosBase, CarriageLink(LastCarrier(cell_.external_axes, Carries::kRobot)),
          OnCarrier(LastCarrier(cell_.external_axes, Carries::kRobot), cell_.X_WB));
    ArmChain();
    Frame(kRosPart);
    Fixed(kRosPart, CarriageLink(LastCarrier(cell_.external_axes, Carries::kWorkpiece)),
          OnCarrier(LastCarrier(cell_.external_axes, Carries::kWorkpiece), cell_.X_WP));
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

  void Frame(const std::string& name) { Line("  <link name=\"{}\"/>", name); }

  void Fixed(const std::string& child, const std::string& parent, const Pose& X) {
    Line("  <joint name=\"{}_fixed\" type=\"fixed\">{}<parent link=\"{}\"/><child link=\"{}\"/></joint>",
         child, Origin(X), parent, child);
  }

  void Moving(const std::string& name, const char* type, const std::string& parent, const std::string& child,
              const Pose& X, const Eigen::Vector3d& axis, const JointLimits& limits) {
    Frame(child);
    Line("  <joint name=\"{}\" type=\"{}\">{}<parent link=\"{}\"/><child link=\"{}\"/>", name, type,
         Origin(X), parent, child);
    Line("    <axis xyz=\"{}\"/><limit lower=\"{}\" upper=\"{}\" velocity=\"{}\" effort=\"0\"/></joint>",
         Text(axis), Text(limits.lower), Text(limits.upper), Text(limits.speed));
  }

  /// The link that an external axis moves, or world.
  std::string CarriageLink(int axis) const {
    return axis == kNoCarrier ? kRosWorld : names_.carriages[static_cast<size_t>(axis)];
  }
  /// Where its frame stands in W with all axes at 0: parallel to W, on the line of a rotary axis.
  Eigen::Vector3d PlaceOf(int axis) const {
    if (axis == kNoCarrier) return Eigen::Vector3d::Zero();
    const ExternalAxis& of = cell_.external_axes[static_cast<size_t>(axis)];
    return of.kind == AxisKind::kRotary ? of.origin : Eigen::Vector3d::Zero();
  }
  Pose OnCarrier(int axis, const Pose& X_W) const { return Eigen::Translation3d(-PlaceOf(axis)) * X_W; }

  void Axes(Carries carried) {
    for (size_t i = 0; i < cell_.external_axes.size(); ++i) {
      const ExternalAxis& axis = cell_.external_axes[i];
      if (axis.carries != carried) continue;
      const int own = static_cast<int>(i), under = CarrierOfAxis(cell_.external_axes, own);
      const bool turns = axis.kind == AxisKind::kRotary;
      const double unit = turns ? 1 : kMetre;
      Moving(names_.joints[6 + i], turns ? "revolute" : "prismatic", CarriageLink(under), names_.carriages[i],
             Pose(Eigen::Translation3d(PlaceOf(own) - PlaceOf(under))), axis.direction,
             {axis.lower / unit, axis.upper / unit, axis.speed / unit});
    }
  }

  /// Between two frames of the arm only the joint between them counts: at angle 0 it is the joint's place.
  void ArmChain() {
    static constexpr std::array kAxes = {2, 1, 1, 0, 1, 2};  // z, y, y, x, y, z, of the frame behind
    const std::array<Pose, 7> frames = LinkFrames(cell_.arm, Joints::Zero());
    std::string parent = kRosBase;
    for (size_t i = 0; i < 6; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      Moving(names_.joints[i], "revolute", parent, names_.links[i],
             frames[i].inverse(Eigen::Isometry) * frames[i + 1],
             cell_.arm.sign[i] * Eigen::Vector3d::Unit(kAxes[i]),
             {cell_.arm.lower[k], cell_.arm.upper[k], cell_.arm.speed[k]});
      parent = names_.links[i];
    }
    Frame(kRosFlange);
    Fixed(kRosFlange, parent, Pose::Identity());
    Frame(kRosTip);
    Fixed(kRosTip, kRosFlange, cell_.X_FT);
  }

  /// What a body hangs on, and where its shape stands there.
  std::pair<std::string, Pose> MountOf(const Body& body) const {
    switch (body.mount) {
      case Mount::kLink:
        return {body.link == 0 ? kRosBase : names_.links[static_cast<size_t>(body.link) - 1], body.X_MG};
      case Mount::kTool:
        return {kRosTip, body.X_MG};
      case Mount::kWorkpiece:
        return {kRosPart, body.X_MG};
      case Mount::kCarriage:
        return {CarriageLink(body.axis), OnCarrier(body.axis, body.X_MG)};
      case Mount::kWorld:
        break;
    }
    return {kRosWorld, body.X_MG};
  }

  void BodyLink(const Body& body, const std::string& name) {
    const auto [parent, X] = MountOf(body);
    Line("  <link name=\"{}\">", name);
    for (const auto& [origin, geometry] : ShapesOf(body, X, name))
      for (const char* use : {"visual", "collision"})
        Line("    <{0}>{1}<geometry>{2}</geometry></{0}>", use, origin, geometry);
    Line("  </link>");
    Fixed(name, parent, Pose::Identity());
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
  const std::string& meshes_;
  CellUrdf urdf_;
};

}  // namespace

CellUrdf MakeCellUrdf(const Cell& cell, const RosNames& names, const std::string& meshes) {
  assert(!cell.deviations);
  return UrdfWriter(cell, names, meshes).Write();
}

}  // namespace millpose
