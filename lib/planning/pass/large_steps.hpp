// SPDX-License-Identifier: GPL-3.0-or-later
// Where points that lie closer together would let a plan be better.
#pragma once

#include "machine/motion/line.hpp"
#include "planning/pass/pass_planner.hpp"

namespace millpose {

/// Which steps of a pass its plan would rather have made larger: entry t is that from point t of `pass` (in
/// W) to the next, of a closed pass also from the last to the first. Those at points that no step joined,
/// with a bound per step those where the pass is split, those that use up what a bound per step leaves
/// (PathOptions::max_deviation, StepBounds::most), and one on both sides. Bounds by way and time grow with
/// the step: no points between help against them.
std::vector<char> LargeSteps(const Carrier& carrier, const Pass& pass, const PassResult& plan,
                             const PathOptions& options);

}  // namespace millpose
