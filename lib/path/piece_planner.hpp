// SPDX-License-Identifier: GPL-3.0-or-later
// The inner part of PlanPass: from the points' own optima to pieces without interference.
#pragma once

#include "path/collision_pruner.hpp"
#include "path/free_optimum.hpp"
#include "path/pass_planner.hpp"
#include "path/refine.hpp"

namespace millpose {

/// What the planning of a pass works on.
struct PassContext {
  const PoseProblem& problem;
  const World& world;
  const PathOptions& options;
  std::span<const MillingPoint> points;
  bool closed;
  int threads;
  std::stop_token stop;
  std::vector<PointScorer> scorers = {};  ///< one per point, as the following
  /// On the grid of the ladder search; null where nothing is to be milled.
  std::vector<std::shared_ptr<const CandidateTable>> tables = {};
  std::vector<PointOptimum> genetic = {};
  std::vector<PointOptimum> optima = {};  ///< of the tables, refined
  std::vector<char> break_before = {};    ///< where the tool is lifted in any case
  std::vector<PaperResult> paper = {};    ///< per point with formulation paper, else empty
  double motion_weight = 0;               ///< objective units per rad² of joint motion (MotionWeight)
};

/// PathOptions::motion_share in units of the objective: times the median of the optima above 0 (a force
/// acts), or times 1 where there is none.
double MotionWeight(double share, std::span<const PointOptimum> optima);

/// A pass cut into pieces.
struct PassPlan {
  std::vector<PathNode> nodes;       ///< one per point; holds where `piece` is not −1
  std::vector<PathNode> unsmoothed;  ///< the same before SmoothPieces
  std::vector<int> piece;            ///< per point, −1 for a skipped one
  std::vector<Piece> pieces;
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
};

/// What a step between neighbouring points costs; how large it may be is MakeLimits'.
StepRule MakeRule(const PassContext& context, bool all_revolutions);

/// What bounds the motions between neighbouring points.
StepLimits MakeLimits(const PassContext& context);

/// The admissible candidates of every point.
std::vector<Layer> MakeLayers(const PassContext& context, bool all_revolutions);

/// The ladder search over such layers without what `pruner` prunes of them; keeps no memory.
LadderProblem MakeProblem(const PassContext& context, std::span<const Layer> layers,
                          const CollisionPruner& pruner, bool all_revolutions);

/// Ladder search, pruning of what interferes, refinement, splits. Empty when, with all_revolutions
/// false, a piece winds a joint out of its limits (Layer); with all_revolutions there is always a plan.
std::optional<PassPlan> PlanPieces(const PassContext& context, bool all_revolutions);

/// Smooths every piece of a plan; it stays free of interference.
void SmoothPieces(const PassContext& context, PassPlan& plan);

}  // namespace millpose
