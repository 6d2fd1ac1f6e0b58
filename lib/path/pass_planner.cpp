// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/pass_planner.hpp"

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "path/piece_planner.hpp"
#include "plan/point_clearance.hpp"

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

/// Each point's own optima by both searches.
void FindOptima(const PoseProblem& problem, const PathOptions& options, size_t first_point, int threads,
                const std::stop_token& stop, PassContext& context) {
  const size_t count = context.scorers.size();
  context.genetic.resize(count);
  context.exhaustive.resize(count);
  ParallelFor(count, threads, stop, [&](size_t t) {
    context.exhaustive[t] = ExhaustiveSearch(context.scorers[t], problem, options.exhaustive_step);
    context.genetic[t] = GeneticSearch(context.scorers[t], problem, options.genetic,
                                       RandomStream(options.seed, first_point + t));
  });
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
  const Matrix6 C = Compliance(Jacobian(problem.arm, node.q, origin), problem.arm.stiffness) +
                    SeriesComplianceAt(problem.arm, node.q, origin, problem.compliances);
  const Eigen::Vector3d normal = problem.X_WB.linear().transpose() * point.point.normal;
  if (const auto indices = IndicesInPlane(C.topLeftCorner<3, 3>(), normal)) point.indices = *indices;
  point.dexterity = Dexterity(Jacobian(problem.arm, node.q, tip), problem.characteristic_length);
}

/// A point of which no piece has taken hold.
void Skip(const PassContext& context, const PassPlan& plan, size_t t, PlannedPoint& point) {
  const PointOptimum& optimum = context.exhaustive[t];
  if (!optimum.found && !context.genetic[t].found) {
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

PassResult Assemble(const PoseProblem& problem, const World& world, const Pass& pass, int pass_number,
                    const PassContext& context, const PassPlan& plan) {
  PassResult result;
  result.pass = pass_number;
  result.rotation_reference = pass.rotation_reference;
  result.grid_gap = plan.grid_gap;
  result.nodes_struck = plan.nodes_struck;
  result.pieces = plan.pieces;
  for (Piece& piece : result.pieces) piece.pass = pass_number;
  result.points.resize(pass.points.size());
  for (size_t t = 0; t < pass.points.size(); ++t) {
    PlannedPoint& point = result.points[t];
    point.point = pass.points[t];
    point.genetic_optimum = context.genetic[t].found ? context.genetic[t].objective : 0.0;
    point.exhaustive_optimum = context.exhaustive[t].found ? context.exhaustive[t].objective : 0.0;
    point.genetic_evaluations = context.genetic[t].evaluations;
    if (plan.piece[t] < 0) {
      Skip(context, plan, t, point);
    } else {
      point.piece = plan.piece[t];
      Describe(problem, plan.nodes[t], point);
    }
  }
  result.poses_checked =
      plan.poses_checked +
      CheckInParallel(world, pass.points.size(), context.threads, context.stop,
                      [&](Checker& checker, size_t t) {
                        PlannedPoint& point = result.points[t];
                        if (plan.piece[t] < 0) return;
                        point.clearance = checker.Clearance(point.q, Phase::kCutting, kPointClearanceBound);
                      });
  return result;
}

}  // namespace

PassResult PlanPass(const PoseProblem& problem, const World& world, const Pass& pass, int pass_number,
                    size_t first_point, const PathOptions& options, int threads, std::stop_token stop) {
  PassContext context{problem, world, options, pass.closed, threads, stop, {}, {}, {}};
  for (const MillingPoint& point : pass.points) {
    context.scorers.emplace_back(problem, point, pass.rotation_reference);
  }
  FindOptima(problem, options, first_point, threads, stop, context);

  // Full turns hardly ever matter, so first every node stands for all of its own; where the joints then wind
  // out of their limits, each turn becomes a node.
  std::optional<PassPlan> plan = PlanPieces(context, false);
  if (!plan) plan = PlanPieces(context, true);
  return Assemble(problem, world, pass, pass_number, context, *plan);
}

}  // namespace millpose
