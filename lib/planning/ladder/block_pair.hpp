// SPDX-License-Identifier: GPL-3.0-or-later
// A block of nodes and one of the layer before it, in the kernels that look at all pairs of them at once
// (block_kernel, mask_kernel).
#pragma once

#include <cmath>
#include <cstring>

#include "planning/ladder/edge_kernel.hpp"
#include "planning/ladder/short_way.hpp"

namespace millpose::block_pair {

inline InstructionSet Widest() {
  static const InstructionSet set = WidestInstructionSet();
  return set;
}

/// One joint of a block of nodes as lanes.
inline void Load(const std::vector<double>& joint, size_t begin, Lanes& lanes) {
  static_assert(sizeof lanes.v == kBlock * sizeof(double));
  std::memcpy(lanes.v, &joint[begin], sizeof lanes.v);  // copied in place: std::copy_n calls memmove
}

/// Whether some pair may be within a step. `square`: then the least that the joints turn by, squared and
/// summed.
inline bool MayReach(const StepRule& rule, const JointRows::Bound& from, const JointRows::Bound& to,
                     double& square) {
  constexpr std::array<int, 6> kOrder{3, 5, 4, 0, 1, 2};  // those first that turn most along a layer
  constexpr double kSlack = 1e-9;                         // rad: rounding of the bounds
  square = 0;
  for (const int i : kOrder) {
    const double apart = std::fabs(short_way::Short(to.middle[i] - from.middle[i]));
    const double nearest = apart - from.radius[i] - to.radius[i] - kSlack;
    if (nearest > rule.max_step[i]) return false;
    if (nearest > 0) square += nearest * nearest;
  }
  return true;
}

/// How far the pairs are apart by full revolutions, rad. Where all are as many, that takes less arithmetic
/// and gives the same bits.
struct Shifts {
  std::array<double, 6> of;
  bool same = true;
};

inline Shifts ShiftsBetween(const StepRule& rule, const JointRows::Bound& from, const JointRows::Bound& to) {
  constexpr double kOneTurn = 3.0;  // rad: angles that lie nearer are as many turns away
  Shifts shifts{};
  if (!rule.modulo_revolutions) return shifts;
  shifts.same = from.same_turn && to.same_turn;
  for (int i = 0; i < 6; ++i) {
    shifts.of[i] = short_way::Turns(to.middle[i] - from.middle[i]) * short_way::kTurn;
    shifts.same = shifts.same && from.radius[i] + to.radius[i] + rule.max_step[i] < kOneTurn;
  }
  return shifts;
}

/// Calls `look(way)`, `way(i, step)` giving the signed step of joint i, as few revolutions as there are.
template <typename Look>
[[gnu::always_inline]] inline void ByTheShortWay(const Shifts& shifts, const Look& look) {
  if (shifts.same)
    look([&] [[gnu::always_inline]] (int i, double step) { return step - shifts.of[i]; });
  else
    look([&] [[gnu::always_inline]] (int, double step) { return short_way::Short(step); });
}

}  // namespace millpose::block_pair
