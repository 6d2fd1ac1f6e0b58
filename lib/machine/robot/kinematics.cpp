// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/kinematics.hpp"

#include <cmath>

#include "base/units.hpp"
#include "machine/robot/angles.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// R·Rx(angle).
Matrix3d TurnX(const Matrix3d& R, const SineCosine& angle) {
  Matrix3d turned;
  turned.col(0) = R.col(0);
  turned.col(1) = angle.cos * R.col(1) + angle.sin * R.col(2);
  turned.col(2) = angle.cos * R.col(2) - angle.sin * R.col(1);
  return turned;
}

/// R·Ry(angle).
Matrix3d TurnY(const Matrix3d& R, const SineCosine& angle) {
  Matrix3d turned;
  turned.col(0) = angle.cos * R.col(0) - angle.sin * R.col(2);
  turned.col(1) = R.col(1);
  turned.col(2) = angle.cos * R.col(2) + angle.sin * R.col(0);
  return turned;
}

/// R·Rz(90°).
Matrix3d QuarterTurned(const Matrix3d& R) {
  Matrix3d turned;
  turned << R.col(1), -R.col(0), R.col(2);
  return turned;
}

double ForearmLength(const Arm& arm) { return std::sqrt(arm.d4 * arm.d4 + arm.dz * arm.dz); }

Pose PoseOf(const Matrix3d& R, const Vector3d& p) {
  Pose X = Pose::Identity();
  X.linear() = R;
  X.translation() = p;
  return X;
}

}  // namespace

std::string CoupledText(const CoupledLimit& limit, const Joints& q) {
  std::string sum;
  for (int i = 0; i < 6; ++i) {
    const double factor = limit.factors[i];
    if (factor == 0) continue;
    sum += sum.empty() ? (factor < 0 ? "−" : "") : (factor < 0 ? " − " : " + ");
    if (std::abs(factor) != 1) sum += fmt::format("{:.6g}·", std::abs(factor));
    sum += fmt::format("A{}", i + 1);
  }
  return fmt::format("{} = {:.3f}° is above {:.3f}°", sum, RadToDeg(limit.factors.dot(q)),
                     RadToDeg(limit.at_most));
}

Joints OuterAngles(const Arm& arm, const Joints& q) {
  Joints A;
  for (int i = 0; i < 6; ++i) A[i] = Principal(arm.sign[i] * (q[i] - arm.offset[i]));
  return A;
}

Joints NearestEquivalent(const Joints& near, const Joints& q) {
  constexpr double kNoTurn = 3.14;  // rad, a little less than half a turn: most angles
  Joints moved = q;
  for (int i = 0; i < 6; ++i) {
    if (std::abs(near[i] - q[i]) < kNoTurn) continue;
    const double turns = std::round((near[i] - q[i]) / (2 * kPi));
    if (turns != 0.0) moved[i] += turns * (2 * kPi);
  }
  return moved;
}

double ArmLength(const Arm& arm) {
  return std::abs(arm.a1) + std::abs(arm.dy) + arm.a2 + ForearmLength(arm) + std::abs(arm.d5) +
         std::abs(arm.d6);
}

ArmPlane PlaneOf(const Arm& arm, const Joints& q) {
  const SineCosine second = SinCos(q[1]), third = SinCos(q[2]);
  const SineCosine sum{second.sin * third.cos + second.cos * third.sin,
                       second.cos * third.cos - second.sin * third.sin};
  const double forearm = ForearmLength(arm);
  double radius = arm.a1 + arm.a2 * second.cos + arm.d4 * sum.cos + arm.dz * sum.sin;
  if (arm.family == ArmFamily::kParallelAxes) {
    const SineCosine fourth = SinCos(q[3]);
    radius += arm.d5 * (sum.cos * fourth.cos - sum.sin * fourth.sin);
  }
  return {.radius = radius,
          .second = second,
          .sum = sum,
          .elbow_sine = (third.sin * arm.d4 - third.cos * arm.dz) / forearm};
}

namespace {

/// Of the frames of the links, after the fixed one.
struct Chain {
  Matrix3d R1, R2, R3, R4, R5, R_BF;
  Vector3d top, shoulder, elbow, fourth, wrist, flange;
};

[[gnu::always_inline]] inline Chain ChainOf(const Arm& arm, const Joints& A) {
  Chain chain;
  const Joints q = InnerAngles(arm, A);
  const SineCosine first = SinCos(q[0]);
  const ArmPlane plane = PlaneOf(arm, q);
  chain.R1 << first.cos, -first.sin, 0, first.sin, first.cos, 0, 0, 0, 1;
  chain.R2 = TurnY(chain.R1, plane.second);
  chain.R3 = TurnY(chain.R1, plane.sum);
  const bool parallel = arm.family == ArmFamily::kParallelAxes;
  chain.R4 = TurnX(parallel ? QuarterTurned(chain.R3) : chain.R3, SinCos(q[3]));
  chain.R5 = TurnY(chain.R4, SinCos(q[4]));
  const Matrix3d R6 = TurnX(chain.R5, SinCos(q[5]));
  chain.R_BF << -R6.col(2), R6.col(1), R6.col(0);  // R6·Ry(90°)

  chain.top = Vector3d(0, 0, arm.d1);
  chain.shoulder = chain.top + arm.a1 * chain.R1.col(0) + arm.dy * chain.R1.col(1);
  chain.elbow = chain.shoulder + arm.a2 * chain.R2.col(0);
  chain.fourth = chain.elbow + arm.d4 * chain.R3.col(0) + arm.dz * chain.R3.col(2);
  chain.wrist = chain.fourth - arm.d5 * chain.R4.col(1);
  chain.flange = chain.wrist + arm.d6 * R6.col(0);
  return chain;
}

}  // namespace

LinkPoses LinkFrames(const Arm& arm, const Joints& A) {
  const Chain chain = ChainOf(arm, A);
  return {Pose::Identity(),
          PoseOf(chain.R1, chain.top),
          PoseOf(chain.R2, chain.shoulder),
          PoseOf(chain.R3, chain.elbow),
          PoseOf(chain.R4, chain.fourth),
          PoseOf(chain.R5, chain.wrist),
          PoseOf(chain.R_BF, chain.flange)};
}

Pose ForwardFlange(const Arm& arm, const Joints& A) {
  const Chain chain = ChainOf(arm, A);
  return PoseOf(chain.R_BF, chain.flange);
}

Matrix6 Jacobian(const Arm& arm, const Joints& q, const Vector3d& p_FT) {
  return Jacobian(arm, LinkFrames(arm, q), p_FT);
}

Matrix6 Jacobian(const Arm& arm, const LinkPoses& frames, const Vector3d& p_FT) {
  const Vector3d tip = frames[6] * p_FT;
  // The axis a joint turns about is a fixed axis of the frame after it: z, y, y, x, y, and F's z for the
  // last.
  constexpr int kAxis[6] = {2, 1, 1, 0, 1, 2};
  Matrix6 J;
  for (int i = 0; i < 6; ++i) {
    const Pose& frame = frames[i + 1];
    const Vector3d axis = arm.sign[i] * frame.linear().col(kAxis[i]);
    J.col(i) << axis.cross(tip - frame.translation()), axis;
  }
  return J;
}

int Status(const Arm& arm, const Joints& A) {
  const Joints q = InnerAngles(arm, A);
  const ArmPlane plane = PlaneOf(arm, q);
  return (plane.radius < 0 ? 1 : 0) | (plane.elbow_sine >= 0 ? 2 : 0) | (SinCos(q[4]).sin < 0 ? 4 : 0);
}

int Turn(const Joints& q) {
  int turn = 0;
  for (int i = 0; i < 6; ++i) turn |= (q[i] < 0 ? 1 : 0) << i;
  return turn;
}

SingularityDistance DistanceToSingularity(const Arm& arm, const Joints& A) {
  const Joints q = InnerAngles(arm, A);
  const ArmPlane plane = PlaneOf(arm, q);
  return {std::abs(SinCos(q[4]).sin), std::abs(plane.elbow_sine), std::abs(plane.radius)};
}

}  // namespace millpose
