// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>

#include "planning/ladder/ladder_search.hpp"

namespace millpose {

/// What a path does at one milling point.
struct PathNode {
  FreedomValues freedoms;
  int branch = 0;
  Joints q = Joints::Zero();
  double objective = 0;
  bool genetic = false;  ///< the genetic algorithm's answer
  bool frozen = false;   ///< refinement leaves it as it is
};

/// What the refinement of a piece goes by.
struct RefineOptions {
  StepRule rule;
  std::span<const Joints> max_step;  ///< rad: entry t of the step from point t on; empty: the rule's own
  std::span<const double> max_lean;  ///< rad: likewise of each lean; empty: nothing leans
  double first_step = 0;             ///< rad: the grid that the path comes from
  double last_step = 0;              ///< rad: the grid to end at
  bool closed = false;
  bool all_revolutions = false;  ///< nodes are absolute (Layer)
  bool worst_first = false;      ///< WorstThenSum; the path's worst value never rises
  std::stop_token stop;
};

/// Σ objective + motion along a piece.
double PathCost(std::span<const PathNode> path, const StepRule& rule, std::span<const Joints> max_step,
                bool closed);

/// Searches again around a sequence on ever finer grids: windows around its nodes, their branch kept, with
/// the ends of admissible intervals and the genetic algorithm's answers (`genetic`, one per point) among the
/// nodes where they lie in the window. Where freedoms lean the tool, windows of single points leave every two
/// neighbours within the bound of the lean's change, and before them the leans of the whole path are shifted.
/// Never worsens the cost.
void RefinePath(std::span<const PointScorer> scorers, std::span<const PointOptimum> genetic,
                const RefineOptions& options, std::span<PathNode> path);

}  // namespace millpose
