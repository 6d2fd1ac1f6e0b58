// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/error.hpp"

namespace millpose {

/// What a drilling cycle does along a hole's axis, as heights (mm) that grow out of the hole.
struct Drilling {
  double clearance = 0;         ///< where the feed begins and ends
  std::vector<double> bottoms;  ///< where each stroke ends, falling; the last is the hole's bottom
  double chip_retract = 0;      ///< above 0: how far the tool goes back between strokes; 0: to the clearance
};

/// Strokes of `step` from `top` down to `bottom`; the last one may be shorter. Throws InputError at `place`
/// when the step is not above 0 or they are more than 10,000.
std::vector<double> EvenStrokes(double top, double bottom, double step, const SourceLocation& place);

/// Strokes below `reference`: the first one to `first`, each further one shorter by `less` as long as it is
/// longer than that, the last two of equal length (CYCLE83). Throws InputError as EvenStrokes does.
std::vector<double> ShrinkingStrokes(double reference, double first, double bottom, double less,
                                     const SourceLocation& place);

/// The heights that the tool visits one after the other, from behind the clearance to the clearance again.
/// Throws InputError at `place` when the bottom is not below the clearance.
std::vector<double> Heights(const Drilling& drilling, const SourceLocation& place);

}  // namespace millpose
