// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/pass/candidate_graph.hpp"
#include "planning/pass/pass_planner.hpp"

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
  double memory;                          ///< bytes that its candidates may take
  std::vector<PointScorer> scorers = {};  ///< one per point, as the following
  /// On the grid of the ladder search; null where nothing is to be milled.
  std::vector<std::shared_ptr<const CandidateTable>> tables = {};
  std::vector<std::shared_ptr<PointVerdicts>> verdicts = {};  ///< of what is planned in any way of it
  std::vector<PointOptimum> genetic = {};
  std::vector<PointOptimum> optima = {};  ///< of the tables, refined
  std::vector<char> break_before = {};    ///< where the tool is lifted in any case
  std::vector<PaperResult> paper = {};    ///< per point with formulation paper, else empty
  double motion_weight = 0;               ///< objective units per rad² of joint motion (MotionWeight)
  /// Of each point, where external axes move along the pass: `problem` and `world` are then with them at 0.
  std::shared_ptr<const std::vector<PlaceAlong>> along = nullptr;

  const PoseProblem& ProblemAt(size_t t) const { return along ? (*along)[t].station->problem : problem; }
};

/// The points first..first+count−1 as joint steps are bounded by (StepPoints): all in one frame.
std::vector<MillingPoint> StepPointsOf(const PassContext& context, size_t first, size_t count);

/// PathOptions::motion_share in units of the objective: times the median of the optima above 0 (a force
/// acts), or times 1 where there is none.
double MotionWeight(double share, std::span<const PointOptimum> optima);

/// Throws InputError where `bytes` of candidates are more than they may take.
void CheckMemory(const PassContext& context, double bytes);

/// What a step between neighbouring points costs; how large it may be is the graph's.
StepRule MakeRule(const PassContext& context, bool all_revolutions);

PassChecks MakeChecks(const PassContext& context);

/// The admissible candidates of every point; of the context's verdicts. Throws InputError as CheckMemory().
std::shared_ptr<CandidateGraph> MakeGraph(const PassContext& context, bool all_revolutions);

/// The ladder search over such a graph; keeps no memory.
LadderProblem MakeProblem(const PassContext& context, const CandidateGraph& graph, bool all_revolutions);

}  // namespace millpose
