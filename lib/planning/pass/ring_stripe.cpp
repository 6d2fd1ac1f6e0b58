// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/ring_stripe.hpp"

#include <map>

#include "base/units.hpp"
#include "planning/ladder/lifted_search.hpp"
#include "planning/ladder/worst_then_sum.hpp"

namespace millpose {
namespace {

/// Rotations, first to last node of a run that is pruned.
struct Run {
  double lower = 0, upper = 0;
  size_t count = 0;
};

/// The longest run of blocked nodes of a lane.
Run LongestRun(const Layer& layer, size_t lane) {
  Run longest, run;
  for (size_t k = layer.lane_begin[lane]; k < layer.lane_begin[lane + 1]; ++k) {
    if (std::isfinite(layer.objective[k])) {
      run = {};
      continue;
    }
    if (run.count == 0) run.lower = layer.first[k];
    run.upper = layer.first[k];
    ++run.count;
    if (run.count > longest.count) longest = run;
  }
  return longest;
}

/// The pair of bodies that was met at most points, and at how many.
std::pair<std::optional<ContactCandidate>, size_t> CommonPair(const CandidateGraph& graph) {
  std::map<int, std::pair<ContactCandidate, size_t>> met;
  for (size_t t = 0; t < graph.size(); ++t)
    if (const std::optional<ContactCandidate> sighting = graph.LastContactCandidate(t))
      ++met.try_emplace(sighting->pair, *sighting, 0).first->second.second;
  std::pair<std::optional<ContactCandidate>, size_t> most{std::nullopt, 0};
  for (const auto& [pair, of] : met)
    if (of.second > most.second) most = {of.first, of.second};
  return most;
}

/// The point where the ring loses most against the point's own optimum.
size_t WorstPoint(const ClosedSearch& search) {
  size_t worst = 0;
  double most = 0;
  for (size_t t = 0; t < search.sequence.nodes.size(); ++t) {
    const double own = search.context.optima[t].objective;
    const double lost = search.problem.layers[t].objective[search.sequence.nodes[t]] - own;
    if (search.context.optima[t].found && lost > most) most = lost, worst = t;
  }
  return worst;
}

/// The longest run at the point nearest to `at`, round the ring, where one of the branch is pruned.
std::pair<size_t, Run> RunBeside(const ClosedSearch& search, size_t at) {
  const size_t count = search.problem.layers.size();
  for (size_t away = 0; away <= count / 2; ++away)
    for (const size_t t : {(at + away) % count, (at + count - away) % count}) {
      const Layer& layer = search.problem.layers[t];
      const Run run = LongestRun(layer, static_cast<size_t>(layer.LaneOf(search.sequence.nodes[t])));
      if (run.count > 0) return {t, run};
    }
  return {at, {}};
}

}  // namespace

std::string ExplainStripe(const ClosedSearch& search) {
  constexpr double kNotable = 0.02, kShare = 1.0 / 3;
  constexpr int kSweeps = 2;
  const double closed = search.sequence.cost, barred = closed - search.unbarred;
  if (!(barred > kNotable * search.unbarred)) return "";
  const auto [sighting, points] = CommonPair(search.graph);
  if (!sighting) return "";
  LadderProblem problem = search.problem;
  if (search.context.options.worst_first) problem = Within(problem, WorstOf(problem.layers, search.sequence));
  const std::optional<Sequence> open = LiftedSearch({0, 0, false}).Round(problem, kSweeps);
  if (!open || open->cost > closed - kShare * barred) return "";
  const size_t worst = WorstPoint(search);
  const auto [beside, run] = RunBeside(search, worst);
  if (run.count == 0) return "";
  double own = 0;
  for (const PointOptimum& optimum : search.context.optima) own += optimum.objective;
  const auto above = [&](double cost) { return 100 * (cost / own - 1); };
  Checker checker(search.context.world);
  const Interference between = checker.Measure(*sighting);
  return fmt::format(
      "as a closed ring it costs {:.1f} % more than its points' own optima, {:.1f} % if nothing interfered, "
      "about {:.1f} % left open (strategy rings: `path: open`): {} and {} bar a stripe of rotations, "
      "{:.0f} to {:.0f} deg at point {}, met at {} of {} points, which no closed ring gets across where it "
      "would have to; most is lost at point {}",
      above(closed), above(search.unbarred), above(open->cost), between.first, between.second,
      RadToDeg(run.lower), RadToDeg(run.upper), beside, points, search.problem.layers.size(), worst);
}

}  // namespace millpose
