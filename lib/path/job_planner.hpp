// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "path/gap_planner.hpp"
#include "plan/plan_result.hpp"

namespace millpose {

/// Fixes the full turns of every piece (a small search over the pieces in order: least turning of A4 and A6
/// in the gaps, home first and last) and shifts the passes' joint angles accordingly. `lower`, `upper`:
/// admissible limits.
void FixTurns(std::vector<PassResult>& passes, const Joints& home, const Joints& lower, const Joints& upper);

/// Where each gap begins and ends, in order: from home to the first piece, between pieces, back home. Empty
/// when there is no piece.
std::vector<std::pair<GapEnd, GapEnd>> GapEnds(const Joints& home, const std::vector<PassResult>& passes);

}  // namespace millpose
