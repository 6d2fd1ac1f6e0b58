// SPDX-License-Identifier: GPL-3.0-or-later
// The inner part of PlanPass: from the points' own optima to pieces without interference.
#pragma once

#include "planning/ladder/refine.hpp"
#include "planning/pass/free_optimum.hpp"
#include "planning/pass/pass_context.hpp"
#include "planning/pass/segment_check.hpp"

namespace millpose {

/// A pass cut into pieces.
struct PassPlan {
  std::vector<PathNode> nodes;       ///< one per point; holds where `piece` is not −1
  std::vector<PathNode> unsmoothed;  ///< the same before SmoothSegments
  std::vector<int> piece;            ///< per point, −1 for a skipped one
  std::vector<Segment> pieces;
  std::vector<std::string> interference;  ///< per point: what barred it; empty when nothing did
  std::vector<std::string>
      access;                     ///< per point: why the pass can be neither entered nor left there, or empty
  std::vector<FreeOptimum> free;  ///< per point
  LadderBound bound;
  std::vector<std::vector<int>> verdicts;  ///< per point, PackVerdicts with the World's pairs
  std::string stripe;                      ///< of a closed ring: ExplainStripe
  double grid_gap = 0;
  long long poses_checked = 0;
  int nodes_pruned = 0;
  long long candidates = 0, candidates_checked = 0;  ///< nodes of the layers
  long long pairs_checked = 0, pairs_saved = 0;      ///< of bodies, at these nodes
  /// What the search has found, for LookBack.
  struct Searched {
    std::shared_ptr<CandidateGraph> graph;
    Sequence sequence;
    bool all_revolutions = false;
    bool best = false;  ///< known to be the best of all sequences, with walls or without
  };
  Searched searched;
};

/// Ladder search, pruning of what interferes, refinement, splits. Empty when, with all_revolutions
/// false, a piece winds a joint out of its limits (Layer); with all_revolutions there is always a plan.
std::optional<PassPlan> PlanSegments(const PassContext& context, bool all_revolutions);

/// What checks a piece of the pass.
SegmentChecker MakeChecker(const PassContext& context, const Segment& piece);

/// What the reports tell of the layers once the plan stands (price.hpp): free optima, bound, verdicts.
void LookBack(const PassContext& context, PassPlan& plan);

/// Smooths every piece of a plan; it stays free of interference.
void SmoothSegments(const PassContext& context, PassPlan& plan);

}  // namespace millpose
