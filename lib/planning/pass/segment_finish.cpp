// SPDX-License-Identifier: GPL-3.0-or-later
// What comes after the search of a pass: what reports tell of it, and smoothing.
#include "planning/ladder/ladder_bound.hpp"
#include "planning/pass/free_smoothing.hpp"
#include "planning/pass/layer_verdicts.hpp"
#include "planning/pass/lean_courses.hpp"
#include "planning/pass/segment_planner.hpp"

namespace millpose {

SegmentChecker MakeChecker(const PassContext& context, const Segment& piece) {
  const auto first = static_cast<size_t>(piece.first), count = static_cast<size_t>(piece.last) - first + 1;
  PassChecks checks = MakeChecks(context);
  if (!checks.along.empty()) checks.along = checks.along.subspan(first, count);
  return {std::move(checks), std::span(context.verdicts).subspan(first, count), context.options.leave};
}

void LookBack(const PassContext& context, PassPlan& plan) {
  CandidateGraph& graph = *plan.searched.graph;
  const Sequence& sequence = plan.searched.sequence;
  graph.GiveBack(sequence);
  const long long before = graph.counts().poses;
  plan.free = FindFreeOptima(context.optima, sequence, graph);
  plan.poses_checked += graph.counts().poses - before;
  LadderProblem problem = MakeProblem(context, graph, plan.searched.all_revolutions);
  problem.memory = &graph.sweeps();
  const bool worst_first = context.options.worst_first;
  plan.bound = plan.searched.best ? BoundOfBest(problem.layers, sequence, worst_first)
                                  : BoundLadder(problem, sequence, worst_first);
  // What is known of one lean says nothing of the others, and the axis map shows one.
  if (context.problem.freedoms.size() == 1 && context.problem.freedoms[0]->IsToolRotation()) {
    for (size_t t = 0; t < graph.size(); ++t) plan.verdicts.push_back(PackVerdicts(LayerVerdicts(graph, t)));
  }
  plan.searched = {};
}

void SmoothSegments(const PassContext& context, PassPlan& plan) {
  plan.unsmoothed = plan.nodes;
  for (const Segment& piece : plan.pieces) {
    SegmentChecker checker = MakeChecker(context, piece);
    const auto first = static_cast<size_t>(piece.first), count = static_cast<size_t>(piece.last) - first + 1;
    const std::span<const MillingPoint> points = context.points.subspan(first, count);
    SmoothOptions options;
    options.loss = context.options.smoothing_loss / static_cast<double>(context.problem.freedoms.size());
    options.max_step =
        StepBoundsAlong(context.options.steps, context.problem.arm, StepPointsOf(context, first, count));
    options.max_lean = LeanBounds(context.problem, context.options.max_lean_change, points);
    options.max_deviation = context.options.max_deviation;
    options.keep_worst = context.options.worst_first;
    options.closed = piece.closed;
    options.stop = context.stop;
    if (context.along)
      options.middles = MiddlesAlong(std::span(*context.along).subspan(first, count), points);
    for (options.freedom = 0; options.freedom < context.problem.freedoms.size(); ++options.freedom)
      SmoothFree(std::span(context.scorers).subspan(first, count), points, options, checker,
                 std::span(plan.nodes).subspan(first, count));
    plan.poses_checked += checker.poses_checked();
  }
}

}  // namespace millpose
