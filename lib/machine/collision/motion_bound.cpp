// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/motion_bound.hpp"

namespace millpose {

JointAxes AxesOf(const LinkPoses& X_WL) {
  JointAxes axes;
  // Each axis as a column of the frame after its joint, which turning about it leaves in place.
  constexpr std::array<int, 6> kColumn{2, 1, 1, 0, 1, 2};
  for (int j = 0; j < 6; ++j) {
    axes.point[j] = X_WL[j + 1].translation();
    axes.direction[j] = X_WL[j + 1].linear().col(kColumn[j]);
  }
  return axes;
}

std::array<double, 7> MotionBounds(const JointAxes& axes, int link, const Eigen::Vector3d& centre,
                                   const Eigen::Matrix3d& half_axes, const Joints& turn) {
  Eigen::Matrix<double, 3, 8> corners;
  for (int i = 0; i < 8; ++i) {
    corners.col(i) = centre + half_axes * Eigen::Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  }
  std::array<double, 7> moved{};
  for (int j = link; j >= 1; --j) {
    const Eigen::Vector3d& axis = axes.direction[j - 1];
    const Eigen::Matrix<double, 3, 8> arm = corners.colwise() - axes.point[j - 1];
    const Eigen::Matrix<double, 1, 8> along = axis.transpose() * arm;
    // Convex in the point, so the farthest point of the box is a corner.
    const double square = (arm.colwise().squaredNorm() - along.cwiseAbs2()).maxCoeff();
    moved[j - 1] = moved[j] + turn[j - 1] * (std::sqrt(std::max(square, 0.0)) + moved[j]);
  }
  return moved;
}

double BallMoves(const JointAxes& axes, int link, const Eigen::Vector3d& centre, double radius,
                 const Joints& turn) {
  double moved = 0;
  for (int j = link; j >= 1; --j) {
    const double arm = (centre - axes.point[j - 1]).norm() + radius;
    moved += turn[j - 1] * (arm + moved);
  }
  return moved;
}

}  // namespace millpose
