// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/process_force.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "base/decompositions.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// Angles of engagement, from the side the cutter's front turns away from (left of the feed), clockwise.
struct ToothArc {
  double start, end;
};

ToothArc ToothArcOf(const Cut& cut) {
  if (cut.side == MillingSide::kSlot) return {0, kPi};
  const double cosine = 1 - 2 * cut.width / cut.diameter;
  const double arc = Atan2(std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine))), cosine);
  return cut.side == MillingSide::kUp ? ToothArc{0, arc} : ToothArc{kPi - arc, kPi};
}

/// Force on the tool of one edge at angle `phi`; zero outside the engagement.
Vector3d EdgeForce(const Cut& cut, const ToothArc& engagement, double phi) {
  if (phi < engagement.start || phi > engagement.end) return Vector3d::Zero();
  const auto [s, c] = SinCos(phi);
  const double chip = cut.feed_per_tooth * std::max(0.0, s);
  const double tangential = chip > 0 ? cut.material.kc11 * cut.depth * Pow(chip, 1 - cut.material.mc) : 0.0;
  const double radial = cut.radial_ratio * tangential;
  return {-tangential * c - radial * s, tangential * s - radial * c, cut.axial_ratio * tangential};
}

/// Largest change of the deflection from a point to the nearest one of any other pass. Points are sorted
/// along the face's longest side, so that a search ends where that side alone is farther than the best.
double LargestStep(const std::vector<FacePoint>& points) {
  Vector3d lower = points.front().position, upper = lower;
  for (const FacePoint& point : points) {
    lower = lower.cwiseMin(point.position);
    upper = upper.cwiseMax(point.position);
  }
  int axis = 0;
  (upper - lower).maxCoeff(&axis);
  std::vector<const FacePoint*> sorted;
  for (const FacePoint& point : points) sorted.push_back(&point);
  std::ranges::stable_sort(sorted, {}, [&](const FacePoint* point) { return point->position[axis]; });
  double largest = 0;
  for (size_t i = 0; i < sorted.size(); ++i) {
    const FacePoint& here = *sorted[i];
    const FacePoint* nearest = nullptr;
    double best = std::numeric_limits<double>::infinity();
    // False where this one and all beyond it are farther than the best.
    const auto consider = [&](const FacePoint& other) {
      const double along = other.position[axis] - here.position[axis];
      if (along * along > best) return false;
      const double distance = (other.position - here.position).squaredNorm();
      if (other.pass != here.pass && distance < best) {
        best = distance;
        nearest = &other;
      }
      return true;
    };
    for (size_t j = i + 1; j < sorted.size() && consider(*sorted[j]);) ++j;
    for (size_t j = i; j > 0 && consider(*sorted[j - 1]);) --j;
    if (nearest) largest = std::max(largest, std::abs(nearest->deflection - here.deflection));
  }
  return largest;
}

}  // namespace

CuttingForce MeanCuttingForce(const Cut& cut) {
  assert(cut.teeth > 0 && cut.diameter > 0 && cut.width <= cut.diameter);
  const ToothArc engagement = ToothArcOf(cut);
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

PredictedDeflection PredictDeflection(const Eigen::Matrix3d& c, const Vector3d& force, const Vector3d& normal,
                                      const Vector3d& feed) {
  const Vector3d moved = c * force;
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
  const Eigen::VectorXd rest = b - A * LeastSquares(A, b);
  result.variation = rest.maxCoeff() - rest.minCoeff();
  result.largest_step = LargestStep(points);
  return result;
}

}  // namespace millpose
