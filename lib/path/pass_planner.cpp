// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/pass_planner.hpp"

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "path/split_planner.hpp"
#include "plan/continuity.hpp"
#include "plan/point_clearance.hpp"
#include "stiffness/pose_stiffness.hpp"

namespace millpose {
namespace {

SkipReason ReasonOf(Admissibility admissibility) {
  switch (admissibility) {
    case Admissibility::kLimit:
      return SkipReason::kLimit;
    case Admissibility::kSingular:
      return SkipReason::kSingular;
    default:
      return SkipReason::kUnreachable;
  }
}

std::string DetailOf(Admissibility admissibility) {
  switch (admissibility) {
    case Admissibility::kLimit:
      return "every reachable pose violates a joint limit less the margin";
    case Admissibility::kSingular:
      return "every pose within the limits is too near a singularity or below the least dexterity";
    default:
      return "the arm reaches the point in no rotation about the tool axis";
  }
}

/// What a planned point says about itself.
void Describe(const PoseProblem& problem, const PathNode& node, PlannedPoint& point) {
  point.freedoms = node.freedoms;
  for (size_t d = 0; d < point.freedoms.size(); ++d) {
    const Freedom& freedom = *problem.freedoms[d];
    const double range = freedom.Upper() - freedom.Lower();
    if (freedom.Periodic()) {
      point.freedoms[d] -= range * std::floor((point.freedoms[d] - freedom.Lower()) / range);
    }
  }
  point.branch = node.branch;
  point.q = node.q;
  point.objective = node.objective;
  point.from_genetic = node.genetic;
  const Eigen::Vector3d tip = problem.X_FT.translation();
  const Eigen::Vector3d origin = problem.origin == StiffnessOrigin::kToolTip ? tip : Eigen::Vector3d::Zero();
  const Eigen::Vector3d normal = problem.X_WB.linear().transpose() * point.point.normal;
  const PoseStiffness stiffness =
      EvaluatePose(problem.arm, node.q, origin, normal, problem.characteristic_length, problem.compliances);
  if (stiffness.indices) point.indices = *stiffness.indices;
  point.lambda_3 = stiffness.lambda[2];
  point.lambda_3_direction = problem.X_WB.linear() * stiffness.directions.col(2);
  point.dexterity = Dexterity(Jacobian(problem.arm, node.q, tip), problem.characteristic_length);
}

/// A point of which no piece has taken hold.
void Skip(const PassContext& context, const PassPlan& plan, size_t t, PlannedPoint& point) {
  const PointOptimum& optimum = context.optima[t];
  if (context.points[t].gouge > 0) {
    point.skip = SkipReason::kGouge;
    point.detail = fmt::format("the cutter would go {:.3f} mm into the part", point.point.gouge);
  } else if (!optimum.found && !context.genetic[t].found) {
    point.skip = ReasonOf(optimum.reason);
    point.detail = DetailOf(optimum.reason);
  } else if (plan.interference[t].empty()) {
    point.skip = SkipReason::kStep;
    point.detail = "no joint step within the bounds joins it to a point before or after";
  } else {
    point.skip = SkipReason::kInterference;
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
  result.nodes_struck = plan.nodes_struck;
  result.nodes = plan.candidates;
  result.nodes_checked = plan.candidates_checked;
  result.pairs_checked = plan.pairs_checked;
  result.pairs_saved = plan.pairs_saved;
  result.uncut = planned.uncut;
  result.pieces = plan.pieces;
  for (Piece& piece : result.pieces) piece.pass = pass_number;
  result.points.resize(count);
  for (size_t t = 0; t < count; ++t) {
    PlannedPoint& point = result.points[t];
    point.point = planned.points->points[t].point;
    point.genetic_optimum = context.genetic[t].found ? context.genetic[t].objective : 0.0;
    point.own_optimum = context.optima[t].found ? context.optima[t].objective : 0.0;
    point.genetic_evaluations = context.genetic[t].evaluations;
    if (!context.paper.empty()) {
      const PaperResult& paper = context.paper[t];
      point.paper = {{paper.within_tolerance, paper.position_error, paper.angle_error, paper.objective}};
    }
    if (plan.piece[t] < 0) {
      Skip(context, plan, t, point);
    } else {
      point.piece = plan.piece[t];
      Describe(context.problem, plan.nodes[t], point);
    }
  }
  const CheckCounts counts =
      CheckInParallel(context.world, count, context.threads, context.stop, [&](Checker& checker, size_t t) {
        PlannedPoint& point = result.points[t];
        if (plan.piece[t] < 0) return;
        point.clearance = checker.Clearance(point.q, Phase::kCutting, kPointClearanceBound);
      });
  result.poses_checked = plan.poses_checked + counts.poses;
  MeasureSmoothing(plan, result);
  return result;
}

}  // namespace

PassResult PlanPass(const PoseProblem& problem, const World& world, const Pass& pass, int pass_number,
                    size_t first_point, const PathOptions& options, int threads, std::stop_token stop) {
  auto own = std::make_shared<SplitPoints>();
  own->milling = pass.points;
  own->context = std::make_unique<PassContext>(
      PassContext{problem, world, options, own->milling, pass.closed, threads, stop, {}, {}, {}, {}, {}});
  PassContext& context = *own->context;
  std::vector<size_t> all;
  for (size_t t = 0; t < pass.points.size(); ++t) {
    own->points.push_back({pass.points[t], t, -1, false});
    context.scorers.emplace_back(problem, pass.points[t], pass.rotation_reference);
    all.push_back(t);
  }
  context.genetic.resize(all.size());
  context.tables.resize(all.size());
  context.optima.resize(all.size());
  FindOptima(all, first_point, context);
  return Assemble(pass, pass_number, PlanSplit(pass, std::move(own), first_point));
}

}  // namespace millpose
