// SPDX-License-Identifier: GPL-3.0-or-later
// What passes promise when they are run from their end, told from the points' own best poses before anything
// is planned (docs/revolutions.md).
#pragma once

#include "planning/result/pass_value.hpp"
#include "run/pipeline/stages/plan_job.hpp"

namespace millpose {

/// Of a pass's objective: a gain of less is not worth a longer way to the pass's start.
inline constexpr double kGainOfTurning = 0.05;

/// The objective at the points' own best poses.
struct Promise {
  double worst = 0, sum = 0;  ///< of points that cut
  double mean = 0;            ///< over the way of all, as in PassValue
};

/// Passes that promise to be better when they are run from their end.
struct PromisingReversals {
  std::vector<char> promising;  ///< by pass
  Toolpath turned;              ///< in P, run from their end: the promising ones; the others are empty
  std::vector<Promise> laid;    ///< what the promising ones promise as they are laid
};

/// Which of the `wanted` reversible passes promise a gain of more than kGainOfTurning, by the ends of the cut
/// and every fourth point between, each with the force of its way. Kept as a stage. Throws Interrupted.
PromisingReversals FindPromisingReversals(const PreparedJob& prepared, const std::vector<char>& wanted,
                                          bool worst_first, const CheckpointStore& checkpoints,
                                          const Execution& execution);

/// Whether a plan is better by more than kGainOfTurning (IsBetter) than any plan of a pass that promises so
/// much could be.
bool IsBetterThanAny(const PassValue& plan, const Promise& promise, bool worst_first);

}  // namespace millpose
