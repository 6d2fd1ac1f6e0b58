// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/controller_axes.hpp"

#include "base/text.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kZeroAngle = 1e-9;     // rad; nearer to 0 the sign of a computed angle carries only noise
constexpr double kUndetermined = 1e-7;  // below this two angles may share what is left over: 6e-6 degrees

}  // namespace

// The inverse of R = Rx(a)·Ry(b)·Rz(c) is Rz(−c)·Ry(−b)·Rx(−a), which counts as rpy does.
Vector3d ToolAngles(AngleOrder rotation, const Matrix3d& R) {
  if (rotation == AngleOrder::kRpy2) return -ToolAngles(AngleOrder::kRpy, R.transpose());
  return rotation == AngleOrder::kRpy ? Vector3d(AnglesZyx(R).reverse()) : AnglesZxz(R);
}

Matrix3d FromToolAngles(AngleOrder rotation, const Vector3d& abc) {
  if (rotation == AngleOrder::kRpy2)
    return RotationAbout(0, abc[0]) * RotationAbout(1, abc[1]) * RotationAbout(2, abc[2]);
  return rotation == AngleOrder::kRpy ? FromAnglesZyx(abc.reverse()) : FromAnglesZxz(abc);
}

Vector3d ToolAnglesNear(AngleOrder rotation, const Matrix3d& R, const Vector3d& near) {
  if (rotation == AngleOrder::kRpy2) return -ToolAnglesNear(AngleOrder::kRpy, R.transpose(), -near);
  const bool rpy = rotation == AngleOrder::kRpy;
  const int outer = rpy ? 2 : 0, inner = 2 - outer;
  Vector3d first = ToolAngles(rotation, R);
  if (const SineCosine inclined = SinCos(first[1]);
      std::abs(rpy ? inclined.cos : inclined.sin) < kUndetermined) {
    // The outer angle is free: with it held the inner one is what is left over.
    const Matrix3d rest = FromToolAngles(rotation, Vector3d(rpy ? 0 : near[0], first[1], rpy ? near[2] : 0));
    const Matrix3d left = rest.transpose() * R;
    first[outer] = near[outer];
    first[inner] = rpy ? Atan2(left(2, 1), left(2, 2)) : Atan2(left(1, 0), left(0, 0));
  }
  const Vector3d second = rpy ? Vector3d(first[0] + kPi, kPi - first[1], first[2] + kPi)
                              : Vector3d(first[0] + kPi, -first[1], first[2] + kPi);
  const auto nearest = [&](Vector3d abc) {
    for (int i = 0; i < 3; ++i) abc[i] = near[i] + std::remainder(abc[i] - near[i], 2 * kPi);
    return abc;
  };
  const Vector3d a = nearest(first), b = nearest(second);
  return (b - near).cwiseAbs().maxCoeff() < (a - near).cwiseAbs().maxCoeff() ? b : a;
}

int ControllerTurn(const AxisConvention& axes, const Joints& q) {
  const Joints angles = axes.FromArm(q);
  int turn = 0;
  for (int i = 0; i < 6; ++i) turn |= (angles[i] < 0 ? 1 : 0) << i;
  return turn;
}

std::optional<Joints> AnglesAt(const Arm& arm, const AxisConvention& axes, const Pose& X_BF, int status,
                               int turn) {
  const InverseResult inverse = Inverse(arm, X_BF);
  for (int s = 0; s < inverse.count; ++s) {
    if (inverse.solutions[s].branch != status) continue;
    Joints angles = axes.FromArm(inverse.solutions[s].q);
    for (int i = 0; i < 6; ++i) {
      angles[i] = std::remainder(angles[i], 2 * kPi);
      // At 0 the sign is a matter of the last bit: there either state of the turn bit means 0, not a full
      // turn.
      const bool negative = (turn >> i & 1) != 0;
      if (negative && angles[i] > kZeroAngle) angles[i] -= 2 * kPi;
      if (!negative && angles[i] < -kZeroAngle) angles[i] += 2 * kPi;
    }
    return axes.ToArm(angles);
  }
  return std::nullopt;
}

int TurnAsWritten(const Arm& arm, const AxisConvention& axes, const Pose& X_BF, int status, const Joints& q) {
  return ControllerTurn(axes, InverseNear(arm, X_BF, status, q).value_or(q));
}

double Rounded(double value, int decimals) { return ParseNumber(Fixed(value, decimals)).value(); }

std::string Short(double number, int decimals) {
  std::string text = Fixed(number, decimals);
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

std::string Fixed(double number, int decimals) {
  std::string text = fmt::format("{:.{}f}", number, decimals);
  if (text.starts_with('-') && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

}  // namespace millpose
