// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/process_force.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cassert>
#include <map>

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// Angles of engagement, from the side the cutter's front turns away from (left of the feed), clockwise.
struct Engagement {
  double start, end;
};

Engagement EngagementOf(const Cut& cut) {
  if (cut.side == MillingSide::kSlot) return {0, kPi};
  const double cosine = 1 - 2 * cut.width / cut.diameter;
  const double arc = Atan2(std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine))), cosine);
  return cut.side == MillingSide::kUp ? Engagement{0, arc} : Engagement{kPi - arc, kPi};
}

/// Force on the tool of one edge at angle `phi`; zero outside the engagement.
Vector3d EdgeForce(const Cut& cut, const Engagement& engagement, double phi) {
  if (phi < engagement.start || phi > engagement.end) return Vector3d::Zero();
  const auto [s, c] = SinCos(phi);
  const double chip = cut.feed_per_tooth * std::max(0.0, s);
  const double tangential =
      chip > 0 ? cut.material.kc11 * cut.depth * std::pow(chip, 1 - cut.material.mc) : 0.0;
  const double radial = cut.radial_ratio * tangential;
  return {-tangential * c - radial * s, tangential * s - radial * c, cut.axial_ratio * tangential};
}

}  // namespace

const std::vector<CuttingMaterial>& CuttingMaterials() {
  // Typical values of tool makers' catalogues by material group (ISO 513, VDI 3323); see
  // docs/process-force.md.
  static const std::vector<CuttingMaterial> materials{
      {"5A06", 400, 0.25, "catalogue, wrought aluminium not heat-treatable (AlMg6)"},
      {"AlMg", 400, 0.25, "catalogue, wrought aluminium not heat-treatable"},
      {"AlZnMgCu", 650, 0.25, "catalogue, wrought aluminium aged (7075, 2A12)"},
      {"TiAl6V4", 1400, 0.23, "catalogue, titanium alloy annealed"},
      {"X5CrNi18-10", 2000, 0.21, "catalogue, austenitic stainless steel"},
      {"C45", 1600, 0.25, "catalogue, unalloyed steel annealed"},
  };
  return materials;
}

CuttingForce MeanCuttingForce(const Cut& cut) {
  assert(cut.teeth > 0 && cut.diameter > 0 && cut.width <= cut.diameter);
  const Engagement engagement = EngagementOf(cut);
  const double arc = engagement.end - engagement.start;
  CuttingForce result;
  result.mean.setZero();
  // Midpoints: the integrand is zero with a root-like rise at the ends, so a fine grid is simplest.
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i)
    result.mean += EdgeForce(cut, engagement, engagement.start + arc * (i + 0.5) / kSteps);
  result.mean *= arc / kSteps * cut.teeth / (2 * kPi);
  result.engaged = cut.teeth * arc / (2 * kPi);
  const double pitch = 2 * kPi / cut.teeth;
  constexpr int kTurns = 2000;
  for (int i = 0; i < kTurns; ++i) {
    Vector3d sum = Vector3d::Zero();
    for (int tooth = 0; tooth < cut.teeth; ++tooth)
      sum += EdgeForce(cut, engagement, pitch * (static_cast<double>(i) / kTurns + tooth));
    result.peak = std::max(result.peak, sum.norm());
  }
  return result;
}

Vector3d ForceVector(const Vector3d& force, const Vector3d& feed, const Vector3d& tool_axis) {
  const Vector3d across = tool_axis.cross(feed).normalized();
  return force.x() * across.cross(tool_axis) + force.y() * across + force.z() * tool_axis;
}

PredictedDeflection PredictDeflection(const Eigen::Matrix3d& c, const Vector3d& force, const Vector3d& normal,
                                      const Vector3d& feed, const Vector3d& tool_axis) {
  const Vector3d moved = c * ForceVector(force, feed, tool_axis);
  const Vector3d across = normal.cross(feed).normalized();
  return {.normal = normal.dot(moved),
          .feed = across.cross(normal).dot(moved),
          .across = across.dot(moved),
          .length = moved.norm()};
}

std::optional<FaceDeflection> OverFace(const std::vector<FacePoint>& points) {
  if (points.size() < 3) return std::nullopt;
  FaceDeflection result;
  Vector3d centre = Vector3d::Zero();
  for (const FacePoint& point : points) {
    centre += point.position / static_cast<double>(points.size());
    result.level += point.deflection / static_cast<double>(points.size());
  }
  // The plane a + g·(x − centre) that fits the deflections best; what is left is not flat.
  const auto rows = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd A(rows, 4);
  Eigen::VectorXd b(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const FacePoint& point = points[static_cast<size_t>(i)];
    A.row(i) << 1, (point.position - centre).transpose();
    b[i] = point.deflection;
  }
  const Eigen::VectorXd rest = b - A * A.completeOrthogonalDecomposition().solve(b);
  result.variation = rest.maxCoeff() - rest.minCoeff();
  std::map<int, std::vector<const FacePoint*>> passes;
  for (const FacePoint& point : points) passes[point.pass].push_back(&point);
  for (const FacePoint& point : points) {
    const auto next = passes.find(point.pass + 1);
    if (next == passes.end()) continue;
    const auto distance = [&](const FacePoint* other) {
      return (other->position - point.position).squaredNorm();
    };
    const FacePoint* nearest = *std::ranges::min_element(next->second, {}, distance);
    result.largest_step = std::max(result.largest_step, std::abs(nearest->deflection - point.deflection));
  }
  return result;
}

}  // namespace millpose
