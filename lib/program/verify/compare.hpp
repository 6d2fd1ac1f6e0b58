// SPDX-License-Identifier: GPL-3.0-or-later
// A program's replay against the plan's motions.
#pragma once

#include <functional>
#include <span>

#include "base/execution.hpp"
#include "program/verify/replay.hpp"

namespace millpose {

/// Motions first..last (inclusive) that run with feed, one after the other: a cut with its approach and
/// retract.
struct FeedRun {
  size_t first = 0, last = 0;
};

std::vector<FeedRun> FeedRuns(const MotionProgram& program);

/// A program with its replay.
struct Replayed {
  const MotionProgram& program;
  Replay replay;
  std::vector<FeedRun> runs;
};

/// What is known of a motion's clearance.
struct Proof {
  bool proven = true;          ///< as planned, within the options' clearance_reserve
  double clearance_share = 1;  ///< of the cell's clearances, with which the plan made it
  bool sampled = false;        ///< it was handed to the MotionQuery
};

/// Told of a motion of a run and of its instants after its start, `options.step` apart; from several threads.
using MotionQuery =
    std::function<void(size_t motion, std::span<const Instant> instants, std::vector<Finding>& findings)>;

/// Compares the feed runs in their order (tip, axis, rotation, feed, exact stops, corners), the joint motions
/// between them, spindle and outputs. What it samples on the way is handed to `look`. Returns what is known
/// of every motion of `replayed`.
std::vector<Proof> Compare(const Replayed& replayed, const Replayed& plan, const Cell& cell,
                           const VerifyOptions& options, const MotionQuery& look, const Execution& execution,
                           std::vector<Finding>& findings);

}  // namespace millpose
