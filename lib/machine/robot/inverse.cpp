// SPDX-License-Identifier: GPL-3.0-or-later
#include <cassert>

#include "base/units.hpp"
#include "machine/robot/angles.hpp"
#include "machine/robot/closed_form.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {
namespace {

using closed_form::FlangeAxes;
using closed_form::Solution;

FlangeAxes AxesOf(const Arm& arm, const Pose& X_BF) {
  const Eigen::Matrix3d R = X_BF.linear();
  const Eigen::Vector3d wrist = X_BF.translation() - arm.d6 * R.col(2);
  return {{R(0, 0), R(1, 0), R(2, 0)},
          {R(0, 1), R(1, 1), R(2, 1)},
          {R(0, 2), R(1, 2), R(2, 2)},
          {wrist.x(), wrist.y(), wrist.z()}};
}

/// The solution on a branch. Where A5 = 0 leaves q4 (parallel axes: q2 + q3 + q4) free it is the one of
/// `near`, inner angles; without `near` 0 (parallel axes: one within reach).
Solution Solve(const Arm& arm, const FlangeAxes& flange, int branch, const Joints* near) {
  const closed_form::Lengths lengths(arm);
  const closed_form::Choice choice(branch);
  const closed_form::ShoulderAngle shoulder = closed_form::SolveShoulder(lengths, flange, choice.side);
  if (arm.family == ArmFamily::kSphericalWrist) {
    const SineCosine free = near ? SinCos((*near)[3]) : SineCosine{0, 1};
    return closed_form::SolveSpherical(lengths, flange, shoulder, choice, free);
  }
  const SineCosine free = near ? SinCos((*near)[1] + (*near)[2] + (*near)[3])
                               : closed_form::FreeSum(lengths, flange, shoulder, choice);
  return closed_form::SolveParallel(lengths, flange, shoulder, choice, free);
}

/// Outer angles, principal.
Joints AnglesOf(const Arm& arm, const Solution& solution) {
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = Atan2(solution.q[i].sin, solution.q[i].cos);
  return OuterAngles(arm, q);
}

}  // namespace

InverseResult Inverse(const Arm& arm, const Pose& X_BF) {
  assert(arm.a2 > 0 && arm.d4 * arm.d4 + arm.dz * arm.dz > 0);
  InverseResult result;
  if (!X_BF.matrix().allFinite()) return result;
  const FlangeAxes flange = AxesOf(arm, X_BF);
  bool singular = false;
  for (int branch = 0; branch < 8; ++branch) {
    const Solution solution = Solve(arm, flange, branch, nullptr);
    if (!solution.reached) continue;
    singular |= closed_form::IsSingular(solution);
    result.solutions[result.count++] = {AnglesOf(arm, solution), branch};
  }
  if (result.count > 0) result.status = singular ? ReachStatus::kSingular : ReachStatus::kReached;
  return result;
}

std::optional<Joints> InverseNear(const Arm& arm, const Pose& X_BF, int branch, const Joints& near) {
  assert(branch >= 0 && branch < 8 && near.allFinite());
  if (!X_BF.matrix().allFinite()) return std::nullopt;
  const Joints inner = InnerAngles(arm, near);
  const Solution solution = Solve(arm, AxesOf(arm, X_BF), branch, &inner);
  if (!solution.reached) return std::nullopt;
  Joints q = AnglesOf(arm, solution);
  for (int i = 0; i < 6; ++i) q[i] += 2 * kPi * std::floor((near[i] - q[i]) / (2 * kPi) + 0.5);
  return q;
}

double CountRevolutions(const Joints& q, const Joints& lower, const Joints& upper) {
  double count = 1;
  for (int i = 0; i < 6; ++i) {
    const double first = std::ceil((lower[i] - q[i]) / (2 * kPi)),
                 last = std::floor((upper[i] - q[i]) / (2 * kPi));
    count *= std::max(0.0, last - first + 1);
  }
  return count;
}

std::vector<Joints> FullRevolutions(const Joints& q, const Joints& lower, const Joints& upper) {
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
