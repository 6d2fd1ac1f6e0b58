// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/flatness.hpp"

#include <set>

#include "base/decompositions.hpp"
#include "machine/identification/minimum_zone.hpp"

namespace millpose {
namespace {

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

/// Points whose modified z-score 0.6745·|d − median|/MAD is above 3.5 (Iglewicz and Hoaglin 1993).
std::vector<size_t> FindOutliers(const std::vector<double>& distances) {
  const double middle = Median(distances);
  std::vector<double> deviations;
  for (const double distance : distances) deviations.push_back(std::abs(distance - middle));
  const double bound = 3.5 / 0.6745 * Median(deviations);
  std::vector<size_t> outliers;
  for (size_t i = 0; i < distances.size(); ++i)
    if (bound > 0 && deviations[i] > bound) outliers.push_back(i);
  return outliers;
}

/// The least and the greatest of the points along a direction.
std::pair<size_t, size_t> ExtremesAlong(const std::vector<Eigen::Vector3d>& points,
                                        const Eigen::Vector3d& direction) {
  size_t least = 0, greatest = 0;
  for (size_t i = 1; i < points.size(); ++i) {
    if (direction.dot(points[i]) < direction.dot(points[least])) least = i;
    if (direction.dot(points[i]) > direction.dot(points[greatest])) greatest = i;
  }
  return {least, greatest};
}

/// The minimum zone of points that are not all in one plane, by exchange: that of a few of them, to which
/// those are added that stand out of it farthest, until none does. The zone of all is never narrower than
/// that of some, so the last one is the zone of all. Where many points bend evenly their hull has as many
/// corners, and the zone of all at once would take minutes.
MinimumZone ZoneByExchange(const std::vector<Eigen::Vector3d>& points, const Flatness& fit) {
  std::set<size_t> chosen;
  const auto add = [&](const Eigen::Vector3d& direction) {
    const auto [least, greatest] = ExtremesAlong(points, direction);
    const size_t before = chosen.size();
    chosen.insert({least, greatest});
    return chosen.size() > before;
  };
  const Eigen::Vector3d across = fit.normal.unitOrthogonal(), third = fit.normal.cross(across);
  for (const Eigen::Vector3d& direction :
       {fit.normal, across, third, Eigen::Vector3d(across + third), Eigen::Vector3d(across - third)})
    add(direction);
  for (;;) {
    std::vector<Eigen::Vector3d> some;
    for (const size_t i : chosen) some.push_back(points[i]);
    if (some.size() < 4 || AreCoplanar(some)) return FindMinimumZone(points);
    MinimumZone zone = FindMinimumZone(some);
    if (!add(zone.normal)) return zone;
  }
}

}  // namespace

std::optional<Flatness> FitPlane(const std::vector<Eigen::Vector3d>& points) {
  if (points.size() < 3) return std::nullopt;
  Flatness result;
  result.centre.setZero();
  for (const Eigen::Vector3d& point : points) result.centre += point / static_cast<double>(points.size());
  Eigen::MatrixX3d centred(points.size(), 3);
  for (size_t i = 0; i < points.size(); ++i)
    centred.row(static_cast<Eigen::Index>(i)) = points[i] - result.centre;
  // Not the covariance's eigenvectors: squaring would lose deviations below 1e-8 of the face's size.
  const SingularTriples3 svd = SingularOf3(TriangleOf(centred));
  if (svd.values[1] <= 1e-12 * svd.values[0]) return std::nullopt;
  result.normal = svd.V.col(2);
  int largest = 0;
  result.normal.cwiseAbs().maxCoeff(&largest);
  if (result.normal[largest] < 0) result.normal = -result.normal;
  result.zone_normal = result.normal;

  double square = 0;
  for (const Eigen::Vector3d& point : points) {
    result.distances.push_back(result.normal.dot(point - result.centre));
    square += result.distances.back() * result.distances.back();
  }
  const auto [low, high] = std::minmax_element(result.distances.begin(), result.distances.end());
  result.flatness = *high - *low;
  result.rms = std::sqrt(square / static_cast<double>(points.size()));
  return result;
}

std::optional<Flatness> MeasureFlatness(const std::vector<Eigen::Vector3d>& points) {
  std::optional<Flatness> result = FitPlane(points);
  if (!result) return result;
  result->outliers = FindOutliers(result->distances);
  if (AreCoplanar(points)) return result;
  const MinimumZone zone = ZoneByExchange(points, *result);
  result->minimum_zone = zone.width;
  result->zone_normal = zone.normal;
  return result;
}

}  // namespace millpose
