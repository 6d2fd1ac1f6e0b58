// SPDX-License-Identifier: GPL-3.0-or-later
// The compliance indices of one pose of a KR 500 R2830, on standard output in mm/N.
#include <cstdio>
#include <millpose/stiffness.hpp>

int main() {
  millpose::Arm arm;
  arm.d1 = 1045, arm.a1 = 500, arm.a2 = 1300, arm.d4 = 1025, arm.dz = -55, arm.d6 = 290;
  arm.sign = {-1, 1, 1, -1, 1, -1};
  arm.stiffness << 8.9e9, 6.78e9, 1.13e10, 2.01e9, 1.65e9, 1.35e9;
  millpose::Joints q;
  q << 0, -1.1, 1.8, 0.3, 0.9, 0.2;
  const millpose::Matrix6 J = millpose::Jacobian(arm, q, Eigen::Vector3d(-250, 0, 250));
  const Eigen::Matrix3d c = millpose::Compliance(J, arm.stiffness).topLeftCorner<3, 3>();
  const auto indices = millpose::IndicesInPlane(c, Eigen::Vector3d::UnitX());
  if (!indices) return 1;
  std::printf("%.6e %.6e %.6e\n", indices->lambda_t1, indices->lambda_t2, indices->lambda_n);
}
