// SPDX-License-Identifier: GPL-3.0-or-later
// A plan beside the best fixed rotation, as reports show it.
#pragma once

#include <string>
#include <vector>

#include "planning/result/fixed_comparison.hpp"

namespace millpose {

/// One figure over all compared points: of the plan, of the fixed rotation.
struct FixedFigure {
  const char* key;    ///< objective | normal | length
  const char* label;  ///< for the terminal
  OverPoints plan, fixed;
};

/// The objective, and where forces are known |nᵀcF| and |cF| (mm).
std::vector<FixedFigure> FixedFigures(const ComparedFigures& plan, const ComparedFigures& fixed);

/// "worst 0.81, median 0.95" of plan ÷ fixed; "-" where the fixed one is 0.
std::string FixedRatios(const FixedFigure& figure);

/// Reversals and marks of the plan beside those of a fixed rotation: "reversals 10 / 0; marks … / …".
std::string FixedReversals(const GearTally& plan, const GearTally& fixed, bool known);

/// What a comparison is with: "the best single rotation of the job, -144 deg". Of two that come out the same
/// only the first is there.
struct NamedChoice {
  std::string name;
  const FixedChoice* choice;
};
std::vector<NamedChoice> NamedChoices(const FixedComparison& fixed);

}  // namespace millpose
