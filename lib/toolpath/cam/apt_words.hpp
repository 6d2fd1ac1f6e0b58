// SPDX-License-Identifier: GPL-3.0-or-later
// What the major words of CLDATA mean for the path of the tip.
#pragma once

#include "toolpath/cam/apt_scanner.hpp"
#include "toolpath/cam/word_tally.hpp"

namespace millpose {

enum class AptMeaning : uint8_t {
  kUnknown,
  kMotion,         ///< a motion, or what becomes part of the next one
  kState,          ///< changes what further motions mean
  kHarmless,       ///< says nothing about the path
  kSurfaceMotion,  ///< along a surface: only an APT processor can resolve it
  kLeaves,         ///< the tool leaves the part for a place that only the machine knows
};

AptMeaning MeaningOf(const AptStatement& statement);

/// The first word of a statement: "PPRINT" of "PPRINT OPERATION 1".
std::string FirstWord(const AptWord& major);

/// Words that are harmless by what stands behind them. Throws InputError else: CUTCOM other than OFF shifts
/// the path at the machine, INSERT and PREFUN may hold any block of it, TRACUT other than NOMORE moves the
/// points.
void CheckHarmless(const AptStatement& statement);

}  // namespace millpose
