// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/point_fit.hpp"

#include "base/decompositions.hpp"

namespace millpose {
namespace {

Eigen::Vector3d Mean(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

}  // namespace

std::optional<PointFit> FitPoints(const std::vector<Eigen::Vector3d>& from,
                                  const std::vector<Eigen::Vector3d>& to) {
  if (from.size() < 3 || from.size() != to.size()) return std::nullopt;
  const Eigen::Vector3d centre_from = Mean(from), centre_to = Mean(to);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero(), covariance = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector3d a = from[i] - centre_from;
    spread += a * a.transpose();
    covariance += (to[i] - centre_to) * a.transpose();
  }
  const Eigen::Vector3d widths = SingularOf3(spread).values;
  if (!(widths[1] > 1e-8 * widths[0])) return std::nullopt;  // on a line to 1e-4 of its length
  const SingularTriples3 svd = SingularOf3(covariance);
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  sign(2, 2) = (svd.U * svd.V.transpose()).determinant() < 0 ? -1 : 1;
  PointFit fit;
  fit.X.linear() = svd.U * sign * svd.V.transpose();
  fit.X.translation() = centre_to - fit.X.linear() * centre_from;
  double squares = 0;
  for (size_t i = 0; i < from.size(); ++i) {
    fit.residuals.push_back((fit.X * from[i] - to[i]).norm());
    squares += fit.residuals.back() * fit.residuals.back();
    fit.largest = std::max(fit.largest, fit.residuals.back());
  }
  fit.rms = std::sqrt(squares / static_cast<double>(from.size()));
  return fit;
}

}  // namespace millpose
