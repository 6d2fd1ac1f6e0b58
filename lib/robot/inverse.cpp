// SPDX-License-Identifier: GPL-3.0-or-later
#include <cassert>

#include "base/units.hpp"
#include "robot/angles.hpp"
#include "robot/closed_form.hpp"
#include "robot/kinematics.hpp"

namespace millpose {
namespace {

using closed_form::ArmAngles;
using closed_form::FlangeAxes;
using closed_form::WristAngles;

FlangeAxes AxesOf(const Pose& X_BF) {
  const Eigen::Matrix3d R = X_BF.linear();
  return {{R(0, 0), R(1, 0), R(2, 0)}, {R(0, 1), R(1, 1), R(2, 1)}, {R(0, 2), R(1, 2), R(2, 2)}};
}

ArmAngles SolveArm(const Arm& arm, const Pose& X_BF, int branch) {
  const Eigen::Vector3d wrist = X_BF.translation() - arm.d6 * X_BF.linear().col(2);
  return closed_form::SolveArm(closed_form::Lengths(arm), wrist.x(), wrist.y(), wrist.z(),
                               branch & 1 ? -1 : 1, branch & 2 ? 1 : -1);
}

/// Outer angles, principal. `fourth` is the inner q4 to take where A5 = 0 leaves it free.
Joints SolveRest(const Arm& arm, const ArmAngles& angles, const FlangeAxes& flange, bool flipped,
                 double fourth, bool& singular) {
  const WristAngles wrist = closed_form::SolveWrist(angles, flange, SinCos(fourth));
  singular |= wrist.singular;
  const double flip = flipped ? -1 : 1;                // (q4 + π, −q5, q6 + π) is the same rotation,
  const double half_turn = wrist.singular ? 1 : flip;  // but where q5 = 0, −q5 alone already is
  const Joints q{{Atan2(angles.first.sin, angles.first.cos), Atan2(angles.second.sin, angles.second.cos),
                  Atan2(angles.third.sin, angles.third.cos),
                  Atan2(half_turn * wrist.fourth.sin, half_turn * wrist.fourth.cos),
                  Atan2(flip * wrist.fifth.sin, wrist.fifth.cos),
                  Atan2(half_turn * wrist.sixth.sin, half_turn * wrist.sixth.cos)}};
  return OuterAngles(arm, q);
}

}  // namespace

InverseResult Inverse(const Arm& arm, const Pose& X_BF) {
  assert(arm.a2 > 0 && arm.d4 * arm.d4 + arm.dz * arm.dz > 0);
  InverseResult result;
  if (!X_BF.matrix().allFinite()) return result;
  const FlangeAxes flange = AxesOf(X_BF);
  bool singular = false;
  for (int branch = 0; branch < 8; ++branch) {
    const ArmAngles angles = SolveArm(arm, X_BF, branch);
    if (!angles.reached) continue;
    singular |= closed_form::IsSingular(angles);
    const Joints q = SolveRest(arm, angles, flange, (branch & 4) != 0, 0.0, singular);
    result.solutions[result.count++] = {q, branch};
  }
  if (result.count > 0) result.status = singular ? ReachStatus::kSingular : ReachStatus::kReached;
  return result;
}

std::optional<Joints> InverseNear(const Arm& arm, const Pose& X_BF, int branch, const Joints& near) {
  assert(branch >= 0 && branch < 8 && near.allFinite());
  if (!X_BF.matrix().allFinite()) return std::nullopt;
  const ArmAngles angles = SolveArm(arm, X_BF, branch);
  if (!angles.reached) return std::nullopt;
  bool singular = false;
  Joints q = SolveRest(arm, angles, AxesOf(X_BF), (branch & 4) != 0, InnerAngles(arm, near)[3], singular);
  for (int i = 0; i < 6; ++i) q[i] += 2 * kPi * std::floor((near[i] - q[i]) / (2 * kPi) + 0.5);
  return q;
}

std::vector<Joints> FullTurns(const Joints& q, const Joints& lower, const Joints& upper) {
  std::vector<Joints> all{q};
  for (int i = 0; i < 6; ++i) {
    std::vector<Joints> extended;
    for (const Joints& start : all) {
      for (double turns = std::ceil((lower[i] - q[i]) / (2 * kPi)); q[i] + turns * 2 * kPi <= upper[i];
           ++turns) {
        extended.push_back(start);
        extended.back()[i] = q[i] + turns * 2 * kPi;
      }
    }
    all = std::move(extended);
  }
  return all;
}

}  // namespace millpose
