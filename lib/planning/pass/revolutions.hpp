// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/result/plan_result.hpp"

namespace millpose {

struct TurnOptions {
  Joints home = Joints::Zero();  ///< rad, before the first piece and after the last
  Joints lower, upper;           ///< admissible limits, rad
  /// Passes in one piece may be run the other way round.
  bool free_directions = false;
};

/// Fixes the full revolutions of every piece, and the directions of passes where these are free: the
/// combination with the least turning of all joints in the gaps, Σ |start of a piece − end of the piece
/// before|, home first and last, where a reversed pass counts kReversal more. Shifts the joint angles
/// accordingly; reversed passes hold their points in the order in which they are run.
/// Returns the number of pieces whose limits admit so many combinations that only those nearest home were
/// looked at.
size_t ChooseRevolutions(std::vector<PassResult>& passes, const TurnOptions& options);

/// What reversing a pass must save, rad of turning.
inline constexpr double kReversal = 0.17453292519943295;  // 10°

}  // namespace millpose
