// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/judge_block.hpp"

#include <cmath>

#include "base/units.hpp"

namespace millpose {
namespace {

constexpr double kTurn = 2 * kPi;
constexpr double kRound = 0x1.8p52;  // adding it rounds to a whole number

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

}  // namespace

void Judge(const AdmissibleBounds& bounds, const ArmBranchBlock& branch, const AnglesBlock& angles,
           JudgedBranch& out, InstructionSet set) {
  out.unflipped.limit = Lanes{};
  for (int j = 0; j < 3; ++j) {
    TurnInto(bounds.lower[j], bounds.upper[j], angles.unflipped[j], out.unflipped.q[j], out.unflipped.limit,
             set);
    out.flipped.q[j] = out.unflipped.q[j];
  }
  out.flipped.limit = out.unflipped.limit;
  const std::array<const Lanes*, 3> flipped{&angles.flipped4, &angles.flipped5, &angles.flipped6};
  for (int j = 3; j < 6; ++j) {
    TurnInto(bounds.lower[j], bounds.upper[j], angles.unflipped[j], out.unflipped.q[j], out.unflipped.limit,
             set);
    TurnInto(bounds.lower[j], bounds.upper[j], *flipped[j - 3], out.flipped.q[j], out.flipped.limit, set);
  }
  const double wrist_min = bounds.wrist_min, elbow_min = bounds.elbow_min,
               shoulder_min = bounds.shoulder_min_mm;
  ForEachLane(
      set, [&](int i) __attribute__((always_inline)) {
        const double wrist = wrist_min - std::fabs(branch.wrist.v[i]);
        const double elbow = elbow_min - branch.elbow.v[i];
        const double shoulder = 1e-3 * (shoulder_min - branch.shoulder.v[i]);
        out.singular.v[i] =
            (wrist > 0.0 ? wrist : 0.0) + (elbow > 0.0 ? elbow : 0.0) + (shoulder > 0.0 ? shoulder : 0.0);
      });
}

}  // namespace millpose
