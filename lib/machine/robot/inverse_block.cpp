// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/units.hpp"
#include "machine/robot/angles.hpp"
#include "machine/robot/closed_form.hpp"
#include "machine/robot/inverse_entries.hpp"

namespace millpose {

void FlangeBlock::Set(int lane, const Pose& X_BF) {
  for (int row = 0; row < 3; ++row) {
    x[row].v[lane] = X_BF.linear()(row, 0);
    y[row].v[lane] = X_BF.linear()(row, 1);
    z[row].v[lane] = X_BF.linear()(row, 2);
    p[row].v[lane] = X_BF.translation()[row];
  }
}

namespace {

using closed_form::Choice;
using closed_form::FlangeAxes;
using closed_form::ShoulderAngle;
using closed_form::Solution;

/// ShoulderAngle of a block.
struct ShoulderBlock {
  SineCosineLanes first;
  Lanes reached, distance;
};

[[gnu::always_inline]] inline FlangeAxes AxesOf(const FlangeBlock& flange, double d6, int i) {
  const double z[3] = {flange.z[0].v[i], flange.z[1].v[i], flange.z[2].v[i]};
  return {{flange.x[0].v[i], flange.x[1].v[i], flange.x[2].v[i]},
          {flange.y[0].v[i], flange.y[1].v[i], flange.y[2].v[i]},
          {z[0], z[1], z[2]},
          {flange.p[0].v[i] - d6 * z[0], flange.p[1].v[i] - d6 * z[1], flange.p[2].v[i] - d6 * z[2]}};
}

[[gnu::always_inline]] inline void Store(const Solution& solution, int i, ArmBranchBlock& to) {
  for (int k = 0; k < 6; ++k) {
    to.q[k].sin.v[i] = solution.q[k].sin;
    to.q[k].cos.v[i] = solution.q[k].cos;
  }
  to.reached.v[i] = solution.reached ? 1.0 : 0.0;
  to.wrist.v[i] = std::fabs(solution.q[4].sin);
  to.elbow.v[i] = std::fabs(solution.elbow_sine);
  to.shoulder.v[i] = solution.distance;
}

void SolveShoulders(const closed_form::Lengths& lengths, double d6, const FlangeBlock& flange, double side,
                    ShoulderBlock& out, InstructionSet set) {
  ForEachLane(
      set, [&](int i) __attribute__((always_inline)) {
        const ShoulderAngle shoulder = closed_form::SolveShoulder(lengths, AxesOf(flange, d6, i), side);
        out.first.sin.v[i] = shoulder.first.sin;
        out.first.cos.v[i] = shoulder.first.cos;
        out.reached.v[i] = shoulder.reached ? 1.0 : 0.0;
        out.distance.v[i] = shoulder.distance;
      });
}

[[gnu::always_inline]] inline ShoulderAngle AngleOf(const ShoulderBlock& block, int i) {
  return {{block.first.sin.v[i], block.first.cos.v[i]}, block.reached.v[i] > 0.0, block.distance.v[i], false};
}

}  // namespace

void InverseEntries(const Arm& arm, const FlangeBlock& flange, unsigned entries, ArmBranches& out,
                    InstructionSet set) {
  constexpr unsigned kInFront = 0b01010101;  // entries with the shoulder in front
  const closed_form::Lengths lengths(arm);
  const double d6 = arm.d6;
  std::array<ShoulderBlock, 2> shoulders;
  for (int behind = 0; behind < 2; ++behind)
    if ((entries & kInFront << behind) != 0)
      SolveShoulders(lengths, d6, flange, behind ? -1 : 1, shoulders[behind], set);
  for (int branch = 0; branch < EntryCount(arm); ++branch) {
    if ((entries >> branch & 1u) == 0) continue;
    const Choice choice(branch);
    const ShoulderBlock& shoulder = shoulders[branch & 1];
    ArmBranchBlock& to = out[branch];
    if (arm.family == ArmFamily::kParallelAxes) {
      ForEachLane(
          set, [&](int i) __attribute__((always_inline)) {
            const FlangeAxes axes = AxesOf(flange, d6, i);
            const ShoulderAngle angle = AngleOf(shoulder, i);
            const SineCosine free = closed_form::FreeSum(lengths, axes, angle, choice);
            Store(closed_form::SolveParallel(lengths, axes, angle, choice, free), i, to);
          });
    } else {
      ForEachLane(
          set, [&](int i) __attribute__((always_inline)) {
            const SineCosine free{0, 1};
            Store(closed_form::SolveSpherical(lengths, AxesOf(flange, d6, i), AngleOf(shoulder, i), choice,
                                              free),
                  i, to);
          });
    }
  }
}

void InverseBlock(const Arm& arm, const FlangeBlock& flange, ArmBranches& out, InstructionSet set) {
  InverseEntries(arm, flange, (1u << EntryCount(arm)) - 1, out, set);
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
