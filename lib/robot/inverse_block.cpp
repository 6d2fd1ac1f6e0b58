// SPDX-License-Identifier: GPL-3.0-or-later
#include "robot/inverse_block.hpp"

#include "base/units.hpp"
#include "robot/angles.hpp"
#include "robot/closed_form.hpp"

namespace millpose {

void FlangeBlock::Set(int lane, const Pose& X_BF) {
  for (int row = 0; row < 3; ++row) {
    x[row].v[lane] = X_BF.linear()(row, 0);
    y[row].v[lane] = X_BF.linear()(row, 1);
    z[row].v[lane] = X_BF.linear()(row, 2);
    p[row].v[lane] = X_BF.translation()[row];
  }
}

void InverseBlock(const Arm& arm, const FlangeBlock& flange, ArmBranches& out, InstructionSet set) {
  const closed_form::Lengths lengths(arm);
  const double d6 = arm.d6;
  for (int branch = 0; branch < 4; ++branch) {
    const double side = branch & 1 ? -1 : 1, elbow = branch & 2 ? 1 : -1;
    ArmBranchBlock& to = out[branch];
    ForEachLane(
        set, [&](int i) __attribute__((always_inline)) {
          const closed_form::FlangeAxes axes{{flange.x[0].v[i], flange.x[1].v[i], flange.x[2].v[i]},
                                             {flange.y[0].v[i], flange.y[1].v[i], flange.y[2].v[i]},
                                             {flange.z[0].v[i], flange.z[1].v[i], flange.z[2].v[i]}};
          const closed_form::ArmAngles angles = closed_form::SolveArm(
              lengths, flange.p[0].v[i] - d6 * axes.z[0], flange.p[1].v[i] - d6 * axes.z[1],
              flange.p[2].v[i] - d6 * axes.z[2], side, elbow);
          const closed_form::WristAngles wrist = closed_form::SolveWrist(angles, axes, {0, 1});
          const SineCosine all[6] = {angles.first, angles.second, angles.third,
                                     wrist.fourth, wrist.fifth,   wrist.sixth};
          for (int k = 0; k < 6; ++k) {
            to.q[k].sin.v[i] = all[k].sin;
            to.q[k].cos.v[i] = all[k].cos;
          }
          to.reached.v[i] = angles.reached ? 1.0 : 0.0;
          to.wrist.v[i] = wrist.fifth.sin;
          to.elbow.v[i] = std::fabs(angles.elbow_sine);
          to.shoulder.v[i] = angles.distance;
        });
  }
}

void AnglesOfBranch(const Arm& arm, const ArmBranchBlock& branch, AnglesBlock& out, InstructionSet set) {
  for (int k = 0; k < 6; ++k) {
    const SineCosineLanes& from = branch.q[k];
    const double sign = arm.sign[k], offset = arm.offset[k];
    Lanes& to = out.unflipped[k];
    ForEachLane(
        set, [&](int i) __attribute__((always_inline)) {
          to.v[i] = Principal(sign * (Atan2(from.sin.v[i], from.cos.v[i]) - offset));
        });
  }
  const std::array<Lanes*, 3> flipped{&out.flipped4, &out.flipped5, &out.flipped6};
  for (int k = 3; k < 6; ++k) {
    const SineCosineLanes& from = branch.q[k];
    const Lanes& wrist = branch.wrist;
    const double sign = arm.sign[k], offset = arm.offset[k];
    Lanes& to = *flipped[k - 3];
    ForEachLane(
        set, [&](int i) __attribute__((always_inline)) {
          // At A5 = 0 only q5 changes its sign (closed_form::SolveWrist).
          const double half_turn = wrist.v[i] < closed_form::kWristTolerance ? 1.0 : -1.0;
          const double s = k == 4 ? -1.0 : half_turn, c = k == 4 ? 1.0 : half_turn;
          to.v[i] = Principal(sign * (Atan2(s * from.sin.v[i], c * from.cos.v[i]) - offset));
        });
  }
}

}  // namespace millpose
