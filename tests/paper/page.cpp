// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/paper/page.hpp"

#include <Eigen/SVD>

#include "base/decompositions.hpp"
#include "base/trig.hpp"

namespace millpose {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Closure Close(const Arm& arm) {
  Matrix3d mean = Matrix3d::Zero();
  for (const Joints& q : kTable6) mean += ForwardFlange(arm, q).linear() / 5;
  const Matrix3d V = SingularOf3(mean).V;
  Closure closure;
  closure.axis = V.col(0) * (V(0, 0) < 0 ? -1 : 1);
  const Vector3d common = (mean * closure.axis).normalized();
  Eigen::Matrix<double, 16, 6> A;  // R·t − c = −p for every pose
  Eigen::Matrix<double, 16, 1> b;
  for (int k = 0; k < 5; ++k) {
    const Pose X_BF = ForwardFlange(arm, kTable6[k]);
    const Vector3d axis = X_BF.linear() * closure.axis;
    closure.axis_spread_deg =
        std::max(closure.axis_spread_deg, RadToDeg(Atan2(axis.cross(common).norm(), axis.dot(common))));
    A.middleRows<3>(3 * k) << X_BF.linear(), -Matrix3d::Identity();
    b.segment<3>(3 * k) = -X_BF.translation();
  }
  // Along the common axis the closures say nothing: the tip is taken 250 mm before the flange's origin.
  A.row(15) << 1e3 * closure.axis.transpose(), 0, 0, 0;
  b[15] = 1e3 * -250;
  const Eigen::VectorXd x = LeastSquares(A, b);
  closure.tip = x.head<3>();
  closure.tip_rms = std::sqrt((A * x - b).head<15>().squaredNorm() / 5);
  return closure;
}

PoseIndices IndicesAt(const Arm& arm, const Joints& q, const Vector3d& p_FT, const Vector3d& normal_F) {
  const Matrix3d c = Compliance(Jacobian(arm, q, p_FT), arm.stiffness).topLeftCorner<3, 3>();
  const Vector3d n = ForwardFlange(arm, q).linear() * normal_F;
  PoseIndices at{*IndicesInPlane(c, n), DeflectionsInPlane(c, n), 0};
  at.f = 0.5 * at.plane.lambda_t2 + 0.5 * at.plane.lambda_n;
  return at;
}

}  // namespace millpose
