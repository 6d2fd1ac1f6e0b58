// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/angles.hpp"

#include "base/trig.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kDegenerate = 1e-9;  // below this cosine (or sine) the first angle carries only noise

}  // namespace

Matrix3d RotationAbout(int axis, double angle) {
  const SineCosine t = SinCos(angle);
  const int next = (axis + 1) % 3, last = (axis + 2) % 3;
  Matrix3d R = Matrix3d::Identity();
  R(next, next) = R(last, last) = t.cos;
  R(last, next) = t.sin;
  R(next, last) = -t.sin;
  return R;
}

Vector3d AnglesZyx(const Matrix3d& R) {
  const double first = Hypot(R(0, 0), R(1, 0)) > kDegenerate ? Atan2(R(1, 0), R(0, 0)) : 0.0;
  const Matrix3d rest = RotationAbout(2, -first) * R;  // = Ry·Rx
  return {first, Atan2(-rest(2, 0), rest(0, 0)), Atan2(-rest(1, 2), rest(1, 1))};
}

Matrix3d FromAnglesZyx(const Vector3d& angles) {
  return RotationAbout(2, angles[0]) * RotationAbout(1, angles[1]) * RotationAbout(0, angles[2]);
}

Vector3d AnglesZxz(const Matrix3d& R) {
  // R's third column is (sin v0·sin v1, −cos v0·sin v1, cos v1).
  const double first = Hypot(R(0, 2), R(1, 2)) > kDegenerate ? Atan2(R(0, 2), -R(1, 2)) : 0.0;
  const Matrix3d rest = RotationAbout(2, -first) * R;  // = Rx·Rz
  return {first, Atan2(-rest(1, 2), rest(2, 2)), Atan2(-rest(0, 1), rest(0, 0))};
}

Matrix3d FromAnglesZxz(const Vector3d& angles) {
  return RotationAbout(2, angles[0]) * RotationAbout(0, angles[1]) * RotationAbout(2, angles[2]);
}

}  // namespace millpose
