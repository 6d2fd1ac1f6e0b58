// SPDX-License-Identifier: GPL-3.0-or-later
// A program's replay against the plan's motions.
#pragma once

#include <stop_token>

#include "verify/replay.hpp"

namespace millpose {

/// Motions first..last (inclusive) that run with feed, one after the other: a cut with its approach and
/// retract.
struct FeedRun {
  size_t first = 0, last = 0;
};

/// Straight and timed motions; the others move as fast as the axes allow.
bool HasFeed(const Motion& motion);
std::vector<FeedRun> FeedRuns(const MotionProgram& program);

/// A program with its replay.
struct Replayed {
  const MotionProgram& program;
  Replay replay;
  std::vector<FeedRun> runs;
};

/// Compares the feed runs in their order (tip, axis, rotation, feed, exact stops), the joint motions between
/// them and the spindle. `unproven` receives the motions whose joints leave the plan's by more than the
/// options' gap_proven.
void Compare(const Replayed& replayed, const Replayed& plan, const Cell& cell, const VerifyOptions& options,
             int threads, std::stop_token stop, std::vector<Finding>& findings,
             std::vector<size_t>& unproven);

}  // namespace millpose
