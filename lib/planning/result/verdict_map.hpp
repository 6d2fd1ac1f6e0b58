// SPDX-License-Identifier: GPL-3.0-or-later
// What the search came to know of a point's poses, for the axis map.
#pragma once

#include <vector>

#include "base/units.hpp"

namespace millpose {

/// Rotations about the tool axis of the axis map: every 3° from −180°. A cell reaches half a step to either
/// side.
inline constexpr int kAxisRotations = 120;
inline constexpr double kAxisStep = 2 * kPi / kAxisRotations;

/// The cell of a rotation (rad, any turn), and how far it is from its middle, rad.
struct AxisCell {
  int index = 0;
  double off = 0;
};
AxisCell AxisCellOf(double rotation);

/// What is known of one pose: nothing, free, or which pair interferes.
inline constexpr int kVerdictUnknown = 0, kVerdictFree = 1, kVerdictPair = 2;

/// Verdicts of a point: kAxisRotations of branch 0, then of branch 1, …; kVerdictPair + p for pair p of
/// PassResult::pairs.
using AxisVerdicts = std::vector<int>;

/// As runs (verdict, length, verdict, length, …), without the last one where nothing is known.
std::vector<int> PackVerdicts(const AxisVerdicts& verdicts);
/// 8 · kAxisRotations verdicts, whatever `runs` holds.
AxisVerdicts UnpackVerdicts(const std::vector<int>& runs);

}  // namespace millpose
