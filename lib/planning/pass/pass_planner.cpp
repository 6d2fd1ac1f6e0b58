// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/pass_planner.hpp"

#include <map>

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "planning/pass/describe_point.hpp"
#include "planning/pass/lifts.hpp"
#include "planning/pass/ring_opening.hpp"
#include "planning/pass/split_planner.hpp"
#include "planning/pass/tell_nearest.hpp"
#include "planning/pose/evaluator.hpp"
#include "planning/pose/lean_problem.hpp"
#include "planning/result/continuity.hpp"
#include "planning/result/point_clearance.hpp"
#include "planning/result/verdict_map.hpp"

namespace millpose {
namespace {

std::string DetailOf(Infeasibility obstacle) {
  switch (obstacle) {
    case Infeasibility::kLimit:
      return "every reachable pose violates a joint limit minus the margin";
    case Infeasibility::kSingular:
      return "every pose within the limits is too near a singularity or below the least dexterity";
    default:
      return "the arm reaches the point in no rotation about the tool axis";
  }
}

/// Numbers of the World's pairs in PassResult::pairs.
using PairNumbers = std::map<int, int>;

int NumberOf(const World& world, int pair, PairNumbers& numbers, PassResult& result) {
  const auto [known, added] = numbers.try_emplace(pair, static_cast<int>(result.pairs.size()));
  if (added) result.pairs.push_back(world.PairName(pair));
  return known->second;
}

/// `runs` of verdicts with the pass's own numbers of pairs.
std::vector<int> NamedPairs(const World& world, std::vector<int> runs, PairNumbers& numbers,
                            PassResult& result) {
  for (size_t i = 0; i < runs.size(); i += 2)
    if (runs[i] >= kVerdictPair)
      runs[i] = kVerdictPair + NumberOf(world, runs[i] - kVerdictPair, numbers, result);
  return runs;
}

/// The best free candidate that is known. The path, free too, may lie between the nodes.
void TellFreeOptimum(const PassContext& context, const PassPlan& plan, size_t t, PlannedPoint& point) {
  const auto take = [&](double objective, double rotation, int branch) {
    if (point.free_branch >= 0 && objective >= point.free_optimum) return;
    point.free_optimum = objective;
    point.free_rotation = Confine(*context.problem.freedoms[0], rotation);
    point.free_branch = branch;
  };
  const FreeOptimum& free = plan.free[t];
  if (free.found) take(free.objective, free.freedoms[0], free.branch);
  for (const PathNode& node : {plan.unsmoothed[t], plan.nodes[t]})
    take(node.objective, node.freedoms[0], node.branch);
  // With several freedoms a search of one point alone may miss the valley that the path found.
  if (context.problem.freedoms.size() == 1 || point.own_optimum <= point.free_optimum) return;
  point.own_optimum = point.free_optimum;
  point.own_rotation = point.free_rotation;
  point.own_branch = point.free_branch;
}

constexpr const char* kAlone = "is alone between skipped points; a single point is no cut";

/// Whether the points beside one are skipped for what is in their own way.
bool StandsAlone(const PassContext& context, const PassPlan& plan, size_t t) {
  const auto lost = [&](size_t k) {
    return context.points[k].gouge > 0 || (!context.optima[k].found && !context.genetic[k].found) ||
           !plan.interference[k].empty() || !plan.access[k].empty();
  };
  return (t == 0 || lost(t - 1)) && (t + 1 == context.points.size() || lost(t + 1));
}

std::string WhyNoStep(const StepBounds& steps) {
  return fmt::format(
      "no joint step within the bounds joins it to a point before or after "
      "(path.max_joint_deg_per_mm: {:g}, joint_speed_share: {:g}{})",
      RadToDeg(steps.per_mm), steps.speed_share, steps.most.allFinite() ? ", max_joint_step_deg" : "");
}

/// How deep the cutter would go into the part at the nominal lean, mm, where another lean was looked for.
double NominalGouge(const PassContext& context, size_t t) {
  if (!context.problem.lean || !context.problem.lean->surface) return 0;
  return context.problem.lean->surface->Gouge(context.points[t].position, context.points[t].tool_axis);
}

/// A point of which no piece has taken hold.
void Skip(const PassContext& context, const PassPlan& plan, size_t t, PlannedPoint& point) {
  const PointOptimum& optimum = context.optima[t];
  if (context.points[t].gouge > 0) {
    point.skip = Infeasibility::kGouge;
    point.detail = fmt::format("the cutter would go {:.3f} mm into the part", point.point.gouge);
  } else if (!optimum.found && !context.genetic[t].found) {
    assert(optimum.reason != Infeasibility::kNone);
    point.skip = optimum.reason;
    point.detail = DetailOf(optimum.reason);
  } else if (!plan.access[t].empty()) {
    point.skip = Infeasibility::kAccess;
    point.detail = plan.access[t];
  } else if (plan.interference[t].empty()) {
    point.skip = Infeasibility::kStep;
    point.detail = StandsAlone(context, plan, t) ? kAlone : WhyNoStep(context.options.steps);
  } else if (const double depth = NominalGouge(context, t); depth > 0) {
    point.skip = Infeasibility::kGouge;
    point.detail = fmt::format(
        "the cutter would go {:.3f} mm into the part at the nominal lean, and no other is free", depth);
  } else {
    point.skip = Infeasibility::kInterference;
    point.detail = plan.interference[t];
  }
}

/// What smoothing made of the pieces, as the report measures accelerations.
void MeasureSmoothing(const PassPlan& plan, PassResult& result) {
  Smoothing& smoothing = result.smoothing;
  smoothing.square_after = SquaredAcceleration(result);
  PassResult before = result;
  for (size_t t = 0; t < before.points.size(); ++t) {
    if (plan.piece[t] < 0) continue;
    before.points[t].q = plan.unsmoothed[t].q;
    smoothing.objective_before += plan.unsmoothed[t].objective;
    smoothing.objective_after += plan.nodes[t].objective;
  }
  smoothing.square_before = SquaredAcceleration(before);
}

PassResult Assemble(const Pass& pass, int pass_number, const SplitPass& planned) {
  const PassContext& context = *planned.points->context;
  const PassPlan& plan = planned.plan;
  const size_t count = planned.points->points.size();
  PassResult result;
  result.pass = pass_number;
  result.rotation_reference = pass.rotation_reference;
  result.grid_gap = plan.grid_gap;
  result.nodes_pruned = plan.nodes_pruned;
  result.nodes = plan.candidates;
  result.nodes_checked = plan.candidates_checked;
  result.pairs_checked = plan.pairs_checked;
  result.pairs_saved = plan.pairs_saved;
  result.uncut = planned.uncut;
  result.bound = plan.bound;
  result.lifts = planned.lifts;
  result.lift_gain = planned.lift_gain;
  result.stripe = plan.stripe;
  result.pieces = plan.pieces;
  for (Segment& piece : result.pieces) piece.pass = pass_number;
  result.points.resize(count);
  PairNumbers pairs;
  for (size_t t = 0; t < count; ++t) {
    PlannedPoint& point = result.points[t];
    point.point = planned.points->points[t].point;
    if (context.along) point.external = (*context.along)[t].external;
    point.genetic_optimum = context.genetic[t].found ? context.genetic[t].objective : 0.0;
    point.own_optimum = context.optima[t].found ? context.optima[t].objective : 0.0;
    point.genetic_evaluations = context.genetic[t].evaluations;
    if (context.optima[t].found) {
      point.own_rotation = Confine(*context.problem.freedoms[0], context.optima[t].freedoms[0]);
      point.own_branch = context.optima[t].branch;
    }
    if (!plan.verdicts.empty()) point.verdicts = NamedPairs(context.world, plan.verdicts[t], pairs, result);
    if (!context.paper.empty()) {
      const PaperResult& paper = context.paper[t];
      point.paper = {{paper.within_tolerance, paper.position_error, paper.angle_error, paper.objective}};
    }
    if (plan.piece[t] < 0) {
      Skip(context, plan, t, point);
    } else {
      point.piece = plan.piece[t];
      DescribePoint(context.ProblemAt(t), plan.nodes[t], point);
      point.unsmoothed = plan.unsmoothed[t].objective;
      TellFreeOptimum(context, plan, t, point);
      const std::optional<ContactCandidate>& barred = plan.free[t].barred;
      if (barred) point.barred = NumberOf(context.world, barred->pair, pairs, result);
    }
  }
  std::vector<std::optional<Interference>> nearest(count);
  const CheckCounts counts =
      CheckInParallel(MakeChecks(context), count, [&](PassCheckers& checkers, size_t t) {
        if (plan.piece[t] < 0) return;
        nearest[t] = checkers.At(t).Nearest(result.points[t].q, Phase::kCutting, kPointClearanceBound);
      });
  for (size_t t = 0; t < count; ++t)
    if (plan.piece[t] >= 0) TellNearest(nearest[t], result.points[t], result);
  result.poses_checked = plan.poses_checked + counts.poses;
  MeasureSmoothing(plan, result);
  return result;
}

/// The points of a pass with their own optima. `along`: PassContext::along.
std::shared_ptr<SplitPoints> Begin(PassContext given, const Pass& pass, size_t first_point) {
  auto own = std::make_shared<SplitPoints>();
  own->milling = pass.points;
  given.points = own->milling;
  own->context = std::make_unique<PassContext>(std::move(given));
  PassContext& context = *own->context;
  std::vector<size_t> all;
  for (size_t t = 0; t < pass.points.size(); ++t) {
    own->points.push_back({pass.points[t], t, -1, false});
    context.scorers.emplace_back(context.ProblemAt(t), pass.points[t], pass.rotation_reference);
    context.verdicts.push_back(std::make_shared<PointVerdicts>());
    all.push_back(t);
  }
  context.genetic.resize(all.size());
  context.tables.resize(all.size());
  context.optima.resize(all.size());
  FindOptima(all, first_point, context);
  context.motion_weight = MotionWeight(context.options.motion_share, context.optima);
  return own;
}

}  // namespace

PassResult PlanPass(const CoordinatedPass& riding, const PassToPlan& wanted, const PathOptions& options,
                    const Execution& execution) {
  const auto& [pass, number, first_point] = wanted;
  assert(!pass.closed && riding.external.size() == pass.points.size());
  const Stations& stations = riding.stations;
  PassContext given{stations.problem(),  stations.world(), options,           {}, false,
                    execution.Threads(), execution.stop,   execution.Memory()};
  given.along = std::make_shared<const std::vector<PlaceAlong>>(MakePlacesAlong(stations, riding.external));
  PassResult result =
      Assemble(pass, number, PlanSplit(pass, Begin(std::move(given), pass, first_point), first_point));
  result.external = *result.points.front().external;
  return result;
}

PassResult PlanPass(const PoseProblem& problem, const World& world, const PassToPlan& wanted,
                    const PathOptions& options, const Execution& execution) {
  const auto& [pass, number, first_point] = wanted;
  auto own = Begin(
      {problem, world, options, {}, pass.closed, execution.Threads(), execution.stop, execution.Memory()},
      pass, first_point);
  const PassContext& context = *own->context;
  if (!IsOpenedRing(pass)) return Assemble(pass, number, PlanSplit(pass, std::move(own), first_point));
  const FoundLifts start =
      pass.opening == RingOpening::kAnywhere ? FindRingStart(context, options.Price()) : FoundLifts{{0}, 0};
  const Pass turned = BeginningAt(pass, start.before.front());
  TurnToBegin(turned, start.before.front(), *own);
  PassResult result = Assemble(turned, number, PlanSplit(turned, std::move(own), first_point));
  result.poses_checked += start.poses_checked;
  result.opened_at = static_cast<int>(start.before.front());
  return result;
}

}  // namespace millpose
