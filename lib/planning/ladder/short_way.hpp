// SPDX-License-Identifier: GPL-3.0-or-later
// Full revolutions in the kernels of steps (edge_kernel, block_kernel).
#pragma once

#include "base/units.hpp"

namespace millpose::short_way {

inline constexpr double kTurn = 2 * kPi;
inline constexpr double kPerTurn = 1 / kTurn;
inline constexpr double kRound = 0x1.8p52;  // adding it rounds to a whole number

/// How many full revolutions an angle is away from 0, rounded.
[[gnu::always_inline]] inline double Turns(double angle, double per_turn = kPerTurn) {
  return (angle * per_turn + kRound) - kRound;
}

/// `angle` less full revolutions; with per_turn = 0 nothing is taken away.
[[gnu::always_inline]] inline double Short(double angle, double per_turn = kPerTurn) {
  return angle - Turns(angle, per_turn) * kTurn;
}

}  // namespace millpose::short_way
