// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/samples/judge_optima.hpp"

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "planning/pose/lean_problem.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

constexpr double kGoodEnough = 0.001;  // relative: "within 0.1 %"

struct JudgedPoint {
  const PassResult* pass;
  PlannedPoint* point;
  size_t number;             ///< in the pass
  double without_table = 0;  ///< the genetic algorithm's optimum; 0 when it has none
};

/// How far a search ended above the optimum, relative; a point that only the exhaustive search could plan
/// counts as missed altogether.
double LinkMoveOf(double found, double optimum) { return found > 0 ? found / optimum - 1 : 1; }

/// The judge's optimum; with leans its grid is coarser, and what it finds is brought down to the nearest
/// local one.
PointOptimum Judge(const PointScorer& scorer, double step) {
  constexpr double kWithLeans = 1 * kRadPerDeg;
  if (!HasLean(scorer.problem())) return ExhaustiveSearch(scorer, step);
  const PointOptimum best = ExhaustiveSearch(scorer, std::max(step, kWithLeans));
  return best.found ? Descend(scorer, best) : best;
}

double Percent(long long part, long long all) {
  return all > 0 ? 100 * static_cast<double>(part) / static_cast<double>(all) : 0;
}

}  // namespace

void JudgeOptima(const Stations& stations, const GeneticOptions& genetic, double step,
                 const Execution& execution, PlanResult& plan, AuditFigures& figures) {
  GeneticOptions without = genetic;
  without.table = 0;
  std::vector<JudgedPoint> judged_points;
  bool paper = false;
  for (PassResult& pass : plan.passes)
    for (size_t i = 0; i < pass.points.size(); ++i) {
      PlannedPoint& point = pass.points[i];
      judged_points.push_back({&pass, &point, i});
      paper = paper || !point.paper.empty();
    }
  ParallelFor(judged_points.size(), execution.Threads(), execution.stop, [&](size_t i) {
    JudgedPoint& judged_point = judged_points[i];
    PlannedPoint& point = *judged_point.point;
    if (point.point.gouge > 0) return;
    const std::shared_ptr<const Station> station = stations.Of(*judged_point.pass, judged_point.number);
    const PoseProblem& problem = station->problem;
    const PointScorer scorer(problem, point.point, judged_point.pass->rotation_reference);
    const PointOptimum judge = Judge(scorer, step);
    point.exhaustive_optimum = judge.found ? judge.objective : 0;
    if (paper) return;  // its individuals are joint angles: there is no table
    const PointOptimum alone = GeneticSearch(scorer, problem, without, RandomStream(plan.seed, i));
    judged_point.without_table = alone.found ? alone.objective : 0;
  });
  long long judged = 0, good = 0, good_without = 0;
  for (const JudgedPoint& judged_point : judged_points) {
    const double optimum = judged_point.point->exhaustive_optimum;
    if (optimum <= 0) continue;
    ++judged;
    const double gap = LinkMoveOf(judged_point.point->genetic_optimum, optimum);
    good += gap <= kGoodEnough;
    good_without += LinkMoveOf(judged_point.without_table, optimum) <= kGoodEnough;
    figures.ga_worst_gap_percent = std::max(figures.ga_worst_gap_percent, 100 * gap);
  }
  figures.ga_share_within_0p1_percent = Percent(good, judged);
  if (!paper) figures.ga_share_without_table_percent = Percent(good_without, judged);
}

}  // namespace millpose
