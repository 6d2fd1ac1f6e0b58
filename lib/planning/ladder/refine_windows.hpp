// SPDX-License-Identifier: GPL-3.0-or-later
// The nodes that a refinement offers a path: windows about what it does.
#pragma once

#include "planning/ladder/refine.hpp"

namespace millpose {

inline constexpr int kHalfWindow = 4;  // steps to either side

/// What a window spans to either side of a node: steps in the first freedom, and one in each other.
struct WindowSpan {
  double step;                 ///< rad
  std::vector<double> others;  ///< rad or mm

  bool operator==(const WindowSpan&) const = default;
};

/// The nodes that a path may take at one point, all in one course. `known`: what `at` stands for is as
/// scoring gives it (PathNode::q by no turns away), and is not scored again.
std::vector<NodeSeed> WindowSeeds(const PointScorer& scorer, const PointOptimum& genetic, const PathNode& at,
                                  const WindowSpan& span, bool known);

/// Shifts of all leans of a path together: none, and one step either way in each.
std::vector<FreedomValues> LeanShifts(const std::vector<double>& steps);

/// The nodes of one point, a course for each shift. Where a lean ends at its range, neighbours come no
/// further apart by that.
std::vector<NodeSeed> ShiftedSeeds(const PointScorer& scorer, const PathNode& at,
                                   const std::vector<FreedomValues>& shifts, const WindowSpan& span);

}  // namespace millpose
