// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>

#include "path/gap_planner.hpp"
#include "plan/plan_result.hpp"

namespace millpose {

/// Fixes the full turns of every piece (a small search over the pieces in order: least turning of A4 and A6
/// in the gaps, home first and last) and shifts the passes' joint angles accordingly. `lower`, `upper`:
/// admissible limits.
void FixTurns(std::vector<PassResult>& passes, const Joints& home, const Joints& lower, const Joints& upper);

/// Plans all gaps of `passes` in their order, home first and last, in parallel.
std::vector<Gap> PlanGaps(const World& world, const std::vector<PassResult>& passes,
                          const GapOptions& options, int threads, std::stop_token stop);

}  // namespace millpose
