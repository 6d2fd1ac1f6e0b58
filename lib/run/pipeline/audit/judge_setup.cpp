// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/audit/judge_setup.hpp"

#include "audit/tessellate.hpp"

namespace millpose {
namespace {

audit::Matrix4 ToJudge(const Pose& X) { return X.matrix().cast<audit::Real>(); }

struct Tessellated {
  audit::Mesh operator()(const Box& box) const { return audit::BoxMesh(box.size.cast<audit::Real>()); }
  audit::Mesh operator()(const Sphere& s) const { return audit::CapsuleMesh(s.radius, 0); }
  audit::Mesh operator()(const Capsule& c) const { return audit::CapsuleMesh(c.radius, c.length); }
  audit::Mesh operator()(const Cylinder& c) const { return audit::Frustum(c.radius, c.radius, c.length); }
  audit::Mesh operator()(const Cone& c) const {
    return audit::Frustum(c.radius_bottom, c.radius_top, c.length);
  }
  audit::Mesh operator()(const Convex& convex) const {
    std::vector<audit::Vector3> points;
    for (const Eigen::Vector3d& p : convex.points) points.push_back(p.cast<audit::Real>());
    return audit::HullMesh(points);
  }
  audit::Mesh operator()(const Triangles& triangles) const {
    audit::Mesh mesh;
    for (const std::array<int, 3>& face : triangles.faces) {
      auto& corners = mesh.emplace_back();
      for (size_t k = 0; k < 3; ++k)
        corners[k] = triangles.vertices[static_cast<size_t>(face[k])].cast<audit::Real>();
    }
    return mesh;
  }
};

/// Of a cutter that stands upright in T: the part within the cutting length, and the rest of it.
void AddCutter(const Body& body, const Cell& cell, std::vector<audit::Body>& bodies) {
  const auto* cylinder = std::get_if<Cylinder>(&body.shape);
  const auto* cone = std::get_if<Cone>(&body.shape);
  const double length = cylinder ? cylinder->length : cone->length;
  const double bottom = cylinder ? cylinder->radius : cone->radius_bottom;
  const double top = cylinder ? cylinder->radius : cone->radius_top;
  const double low = body.X_MG.translation().z() - length / 2;
  const auto radius = [&](double z) { return bottom + (top - bottom) * (z - low) / length; };
  const double split = std::clamp(cell.cutter_length, low, low + length);
  for (const auto& [from, to, in_cut] :
       {std::tuple(low, split, true), std::tuple(split, low + length, false)}) {
    if (to <= from) continue;
    const Pose X_TG(Eigen::Translation3d(0, 0, (from + to) / 2));
    bodies.push_back({body.name, "cutter", 6, in_cut, ToJudge(cell.X_FT * X_TG),
                      audit::Frustum(radius(from), radius(to), to - from)});
  }
}

void AddBody(const Body& body, const Cell& cell, audit::Setup& setup) {
  const bool turned =
      std::holds_alternative<Cylinder>(body.shape) || std::holds_alternative<Cone>(body.shape);
  if (body.body_class == BodyClass::kCutter && turned && body.X_MG.linear().isIdentity(0) &&
      body.X_MG.translation().head<2>().isZero(0))
    return AddCutter(body, cell, setup.bodies);
  audit::Body added;
  added.name = body.name;
  added.kind = WordOf(kBodyClassWords, body.body_class);
  added.in_cut = body.body_class == BodyClass::kCutter;
  added.mesh = std::visit(Tessellated{}, body.shape);
  if (added.mesh.empty()) return;
  Pose X = body.X_MG;
  if (body.mount == Mount::kLink) {
    added.link = body.link;
  } else if (body.mount == Mount::kTool) {
    added.link = 6;
    X = cell.X_FT * X;
  } else if (body.mount == Mount::kWorkpiece) {
    X = cell.X_WP * X;
    added.carrier = audit::LastCarrier(setup, false);
  } else if (body.mount == Mount::kCarriage) {
    added.carrier = body.axis;
    added.guided = true;
  }
  added.X_LG = ToJudge(X);
  setup.bodies.push_back(std::move(added));
}

void AddAxis(const ExternalAxis& axis, audit::Setup& setup) {
  audit::ExternalAxis added;
  added.name = axis.name;
  added.lower = axis.lower, added.upper = axis.upper;
  added.home = axis.home, added.speed = axis.speed;
  added.rotary = axis.kind == AxisKind::kRotary;
  added.carries_robot = axis.carries == Carries::kRobot;
  added.direction = axis.direction.cast<audit::Real>();
  added.origin = axis.origin.cast<audit::Real>();
  added.compliance = axis.compliance.value_or(0);
  setup.axes.push_back(added);
}

}  // namespace

audit::Angles ToJudge(const Joints& q) {
  audit::Angles angles;
  for (size_t i = 0; i < 6; ++i) angles[i] = q[static_cast<Eigen::Index>(i)];
  return angles;
}

std::vector<audit::Real> ToJudge(const ExternalPosition& position) {
  return {position.begin(), position.end()};
}

audit::Setup MakeJudgeSetup(const Cell& cell) {
  audit::Setup setup{};
  const Arm& arm = cell.arm;
  setup.d1 = arm.d1, setup.a1 = arm.a1, setup.a2 = arm.a2;
  setup.d4 = arm.d4, setup.dz = arm.dz, setup.d6 = arm.d6;
  setup.dy = arm.dy, setup.d5 = arm.d5;
  setup.parallel = arm.family == ArmFamily::kParallelAxes;
  for (size_t i = 0; i < 6; ++i) setup.sign[i] = arm.sign[i];
  setup.offset = ToJudge(arm.offset);
  setup.lower = setup.hard_lower = ToJudge(arm.lower);
  setup.upper = setup.hard_upper = ToJudge(arm.upper);
  for (const CoupledLimit& limit : arm.coupled_limits)
    setup.coupled.push_back({ToJudge(limit.factors), limit.at_most});
  setup.X_WB = ToJudge(cell.X_WB);
  setup.X_FT = ToJudge(cell.X_FT);
  setup.X_WP = ToJudge(cell.X_WP);
  setup.excluded_pairs = cell.excluded_pairs;
  setup.clearance_free = cell.clearances.free;
  setup.clearance_cutting = cell.clearances.cutting;
  setup.allowance = cell.allowance;
  for (const ExternalAxis& axis : cell.external_axes) AddAxis(axis, setup);
  for (const Body& body : cell.bodies) AddBody(body, cell, setup);
  return setup;
}

}  // namespace millpose
