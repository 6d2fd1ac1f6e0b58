// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/circle_fit.hpp"

#include <algorithm>

#include "base/decompositions.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {

std::optional<CircleFit> FitCircle(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& axis) {
  if (points.size() < 3) return std::nullopt;
  const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  // About the mean, so that no digits are lost far from the origin: 2 x·c + (r² − c²) = x².
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d d = p - mean;
    const Eigen::Vector3d row(2 * u.dot(d), 2 * v.dot(d), 1);
    const double square = row.head<2>().squaredNorm() / 4;
    A += row * row.transpose();
    b += square * row;
  }
  const double scale = A.topLeftCorner<2, 2>().trace();
  if (!(A.topLeftCorner<2, 2>().determinant() > 1e-9 * scale * scale)) return std::nullopt;
  const Eigen::Vector3d found = SolveSymmetric3(A, b);
  const double square = found.z() + found.head<2>().squaredNorm();
  if (!(square > 0)) return std::nullopt;
  CircleFit fit;
  fit.centre = mean + found.x() * u + found.y() * v;
  fit.radius = std::sqrt(square);
  std::vector<double> angles;
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d d = p - fit.centre;
    const double x = u.dot(d), y = v.dot(d);
    fit.residual = std::max(fit.residual, std::abs(Hypot(x, y) - fit.radius));
    angles.push_back(Atan2(y, x));
  }
  std::ranges::sort(angles);
  fit.widest_gap = angles.front() + 2 * kPi - angles.back();
  for (size_t i = 1; i < angles.size(); ++i)
    fit.widest_gap = std::max(fit.widest_gap, angles[i] - angles[i - 1]);
  return fit;
}

}  // namespace millpose
