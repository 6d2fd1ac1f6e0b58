// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/judge_block.hpp"

#include <cmath>
#include <limits>

#include "base/units.hpp"

namespace millpose {
namespace {

constexpr double kTurn = 2 * kPi;
constexpr double kRound = 0x1.8p52;  // adding it rounds to a whole number
// Less than this is missed by rounding only: the same joints come from the block kernels, from scalar code
// and with other full revolutions.
constexpr double kSingularRounding = 1e-10;

/// Moves angles into [lower, upper] by as few full revolutions as can be; adds to `missed` where none fits.
void TurnInto(double lower, double upper, const Lanes& angle, Lanes& turned, Lanes& missed,
              InstructionSet set) {
  ForEachLane(
      set, [&](int i) __attribute__((always_inline)) {
        const double a = angle.v[i];
        const double turns = (lower - a) * (1 / kTurn);
        const double nearest = (turns + kRound) - kRound;
        const double least = a + (nearest < turns ? nearest + 1.0 : nearest) * kTurn;  // the first not below
        const bool stays = (a >= lower) & (a <= upper);
        const bool fits = (least >= lower) & (least <= upper);
        const double above = least - upper, below = lower - (least - kTurn);
        const double nearer = above < below ? above : below;
        const double gap = nearer > 0.0 ? nearer : 0.0;
        turned.v[i] = stays ? a : (fits ? least : a);
        missed.v[i] += (stays | fits) ? 0.0 : gap;
      });
}

/// Puts the angles of both wrists within the limits; what limits miss (rad) into the shortfalls.
void CheckLimits(const AdmissibleBounds& bounds, const AnglesBlock& angles, CheckedBranch& out,
                 InstructionSet set) {
  CheckedWrist &unflipped = out.unflipped, &flipped = out.flipped;
  const auto turn = [&](int j, const Lanes& angle, CheckedWrist& wrist) {
    TurnInto(bounds.lower[j], bounds.upper[j], angle, wrist.q[j], wrist.shortfall, set);
  };
  unflipped.shortfall = Lanes{};
  for (int j = 0; j < 3; ++j) {
    turn(j, angles.unflipped[j], unflipped);
    flipped.q[j] = unflipped.q[j];
  }
  flipped.shortfall = unflipped.shortfall;
  const std::array<const Lanes*, 3> other{&angles.flipped4, &angles.flipped5, &angles.flipped6};
  for (int j = 3; j < 6; ++j) {
    turn(j, angles.unflipped[j], unflipped);
    turn(j, *other[j - 3], flipped);
  }
}

/// Adds by how much a wrist's angles are beyond limits that couple axes. Axes in them have one revolution
/// within their own limits at most, so the one that was taken is the only one.
void CheckCoupled(const std::vector<CoupledLimit>& limits, CheckedWrist& wrist) {
  for (const CoupledLimit& limit : limits)
    for (int l = 0; l < kLanes; ++l) {
      Joints q;
      for (int j = 0; j < 6; ++j) q[j] = wrist.q[static_cast<size_t>(j)].v[l];
      const double beyond = limit.Beyond(q);
      if (beyond > kRevolutionRounding) wrist.shortfall.v[l] += beyond;
    }
}

/// What is missed of the bounds on singularity (sines, m) and dexterity, of both wrists alike.
void MissedOfSingular(const PoseProblem& problem, const FlangeBlock& flange, const ArmBranchBlock& branch,
                      Lanes& missed, InstructionSet set) {
  const AdmissibleBounds& bounds = problem.bounds;
  const double wrist_min = bounds.wrist_min, elbow_min = bounds.elbow_min,
               shoulder_min = bounds.shoulder_min_mm;
  ForEachLane(
      set, [&](int i) __attribute__((always_inline)) {
        const double wrist = wrist_min - std::fabs(branch.wrist.v[i]);
        const double elbow = elbow_min - branch.elbow.v[i];
        const double shoulder = 1e-3 * (shoulder_min - branch.shoulder.v[i]);
        missed.v[i] =
            (wrist > 0.0 ? wrist : 0.0) + (elbow > 0.0 ? elbow : 0.0) + (shoulder > 0.0 ? shoulder : 0.0);
      });
  if (bounds.dexterity_min <= 0.0) return;
  Lanes dexterity;
  DexterityOfBlock(problem.arm, flange, branch, problem.X_FT.translation(), problem.characteristic_length,
                   dexterity);
  for (int l = 0; l < kLanes; ++l) missed.v[l] += std::max(0.0, bounds.dexterity_min - dexterity.v[l]);
}

}  // namespace

void CheckAdmissible(const PoseProblem& problem, const FlangeBlock& flange, const ArmBranchBlock& branch,
                     CheckedBranch& out, InstructionSet set) {
  AnglesBlock angles;
  AnglesOfBranch(problem.arm, branch, angles);
  CheckLimits(problem.bounds, angles, out, set);
  CheckCoupled(problem.bounds.coupled, out.unflipped);
  CheckCoupled(problem.bounds.coupled, out.flipped);
  Lanes missed;
  MissedOfSingular(problem, flange, branch, missed, set);
  for (CheckedWrist* wrist : {&out.unflipped, &out.flipped}) {
    for (int l = 0; l < kLanes; ++l) {
      const double limit = wrist->shortfall.v[l];
      const double singular = missed.v[l] > kSingularRounding ? missed.v[l] : 0.0;
      if (!(branch.reached.v[l] > 0.0)) {
        wrist->shortfall.v[l] = std::numeric_limits<double>::infinity();
        wrist->obstacle[l] = Infeasibility::kUnreachable;
      } else {
        wrist->shortfall.v[l] = limit > 0.0 ? limit : singular;
        wrist->obstacle[l] = limit > 0.0      ? Infeasibility::kLimit
                             : singular > 0.0 ? Infeasibility::kSingular
                                              : Infeasibility::kNone;
      }
    }
  }
}

}  // namespace millpose
