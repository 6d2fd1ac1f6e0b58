// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/refine.hpp"

#include "base/parallel.hpp"
#include "path/worst_then_sum.hpp"
#include "pose/interval_end.hpp"

namespace millpose {
namespace {

constexpr int kHalfWindow = 4;           // steps to either side
constexpr double kEndTolerance = 1e-12;  // rad

/// Settings around a centre: kHalfWindow steps either way in the first freedom, one in the others.
std::vector<FreedomValues> Window(const PoseProblem& problem, const FreedomValues& centre, double step) {
  std::vector<FreedomValues> settings{{}};
  for (size_t d = 0; d < centre.size(); ++d) {
    const Freedom& freedom = *problem.freedoms[d];
    const int half = d == 0 ? kHalfWindow : 1;
    std::vector<FreedomValues> longer;
    for (const FreedomValues& setting : settings) {
      for (int i = -half; i <= half; ++i) {
        const double value = centre[d] + i * step;
        if (!freedom.Periodic() && (value < freedom.Lower() || value > freedom.Upper())) continue;
        longer.push_back(setting);
        longer.back().push_back(value);
      }
    }
    settings = std::move(longer);
  }
  return settings;
}

/// The nodes that a path may take at one point.
std::vector<NodeSeed> WindowSeeds(const PointScorer& scorer, const PointOptimum& genetic, const PathNode& at,
                                  double step) {
  std::vector<NodeSeed> seeds;
  const auto add = [&](const FreedomValues& freedoms, bool is_genetic) {
    seeds.push_back({freedoms, scorer.ScoreOne(freedoms, at.branch), at.branch, is_genetic});
  };
  add(at.freedoms, at.genetic);
  if (at.frozen) return seeds;
  const std::vector<FreedomValues> settings = Window(scorer.problem(), at.freedoms, step);
  std::vector<Candidate> candidates(8 * settings.size());
  scorer.Score(settings, candidates);
  for (size_t k = 0; k < settings.size(); ++k) {
    const bool admissible = candidates[8 * k + at.branch].obstacle == Obstacle::kNone;
    if (settings[k] != at.freedoms) {
      seeds.push_back({settings[k], candidates[8 * k + at.branch], at.branch, false});
    }
    // Along the first freedom, the end of the interval that lies between two neighbours.
    for (const size_t beside : {k - 1, k + 1}) {
      if (!admissible || beside >= settings.size()) continue;
      if (candidates[8 * beside + at.branch].obstacle == Obstacle::kNone) continue;
      if (!std::equal(settings[k].begin() + 1, settings[k].end(), settings[beside].begin() + 1)) continue;
      FreedomValues end = settings[k];
      int evaluations = 0;
      end[0] =
          IntervalEnd(scorer, settings[k], 0, at.branch, settings[beside][0], kEndTolerance, evaluations);
      if (end != settings[k]) add(end, false);
    }
  }
  if (!at.genetic && genetic.found && genetic.branch == at.branch) {
    const double away = std::abs(WrapToPi(genetic.freedoms[0] - at.freedoms[0]));
    if (away <= kHalfWindow * step) add(genetic.freedoms, true);
  }
  return seeds;
}

double Worst(std::span<const PathNode> path) {
  double worst = 0;
  for (const PathNode& node : path) worst = std::max(worst, node.objective);
  return worst;
}

std::optional<Sequence> Search(const LadderProblem& problem, const RefineOptions& options) {
  if (!options.worst_first) return options.closed ? SearchClosed(problem) : SearchOpen(problem);
  WorstThenSum search;
  return options.closed ? search.Closed(problem) : search.Open(problem);
}

}  // namespace

double PathCost(std::span<const PathNode> path, const StepRule& rule, std::span<const Joints> max_step,
                bool closed) {
  StepRule of = rule;
  const auto step = [&](size_t from, size_t to) {
    if (!max_step.empty()) of.max_step = max_step[from];
    return StepCost(of, path[from].q, path[to].q);
  };
  double cost = 0.0;
  for (size_t t = 0; t < path.size(); ++t) {
    cost += path[t].objective;
    if (t > 0) cost += step(t - 1, t);
  }
  of.modulo_revolutions = true;
  if (closed) cost += step(path.size() - 1, 0);
  return cost;
}

void RefinePath(std::span<const PointScorer> scorers, std::span<const PointOptimum> genetic,
                const RefineOptions& options, std::span<PathNode> path) {
  constexpr int kRepeats = 4;  // a window may move this often before the grid gets finer
  std::vector<Layer> layers(path.size());
  for (double step = options.first_step / kHalfWindow; step >= options.last_step; step /= kHalfWindow) {
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
      CheckStop(options.stop);
      const double before = PathCost(path, options.rule, options.max_step, options.closed),
                   worst_before = Worst(path);
      for (size_t t = 0; t < path.size(); ++t) {
        layers[t] = MakeLayer(scorers[t], WindowSeeds(scorers[t], genetic[t], path[t], step),
                              options.all_revolutions);
      }
      LadderProblem problem{layers, options.rule, {}, false, false, options.stop, {}};
      problem.max_step = options.max_step;
      if (options.worst_first) problem.most = worst_before;
      const std::optional<Sequence> found = Search(problem, options);
      if (!found) break;
      const bool less_worst = options.worst_first && WorstOf(layers, *found) < worst_before;
      if (!(found->cost < before) && !less_worst) break;
      for (size_t t = 0; t < path.size(); ++t) {
        const size_t node = found->nodes[t];
        path[t].freedoms = layers[t].freedoms[node];
        path[t].q = layers[t].joints.At(node);
        path[t].objective = layers[t].objective[node];
        path[t].genetic = layers[t].genetic[node];
      }
      if (std::abs(before - found->cost) < 1e-6 * before) break;
    }
  }
}

}  // namespace millpose
