// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/refine.hpp"

#include "base/parallel.hpp"
#include "planning/ladder/refine_windows.hpp"
#include "planning/ladder/table_layer.hpp"
#include "planning/ladder/worst_then_sum.hpp"

namespace millpose {
namespace {

double Worst(std::span<const PathNode> path) {
  double worst = 0;
  for (const PathNode& node : path) worst = std::max(worst, node.objective);
  return worst;
}

std::optional<Sequence> SearchOnce(const LadderProblem& problem, const RefineOptions& options) {
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

namespace {

class Refiner {
 public:
  Refiner(std::span<const PointScorer> scorers, std::span<const PointOptimum> genetic,
          const RefineOptions& options, std::span<PathNode> path)
      : scorers_(scorers), genetic_(genetic), options_(options), path_(path) {}

  void Run() {
    const bool leans = !options_.max_lean.empty();
    const int repeats = leans ? kLeaningRepeats : kRepeats;
    for (double step = options_.first_step / kHalfWindow; step >= options_.last_step; step /= kHalfWindow) {
      for (int repeat = 0; repeat < repeats; ++repeat) {
        CheckStop(options_.stop);
        const bool shifted = leans && Shift(step) == Gain::kMuch;
        if (Widen(step) != Gain::kMuch && !shifted) break;
      }
    }
  }

 private:
  enum class Gain : uint8_t { kNone, kLittle, kMuch };
  static constexpr int kRepeats = 4;  // a window may move this often before the grid gets finer
  static constexpr int kLeaningRepeats = 12;

  /// Steps of the leans beside one of the rotation: half of their own grid's beside its first.
  std::vector<double> LeanSteps(double step) const {
    std::vector<double> steps;
    const auto& freedoms = scorers_[0].problem().freedoms;
    for (size_t d = 1; d < freedoms.size(); ++d) {
      const double own = freedoms[d]->IsLean() ? freedoms[d]->Step() / 2 : options_.first_step / kHalfWindow;
      steps.push_back(own * (step * kHalfWindow / options_.first_step));
    }
    return steps;
  }

  /// How far the leans of point t may move so that whatever its neighbours do the bound holds.
  double Slack(size_t t) const {
    const size_t count = path_.size();
    double slack = std::numeric_limits<double>::infinity();
    const auto look = [&](size_t from, size_t to) {
      for (size_t d = 1; d < path_[from].freedoms.size(); ++d)
        slack = std::min(
            slack, (options_.max_lean[from] - std::abs(path_[to].freedoms[d] - path_[from].freedoms[d])) / 2);
    };
    if (t > 0 || options_.closed) look((t + count - 1) % count, t);
    if (t + 1 < count || options_.closed) look(t, (t + 1) % count);
    return std::max(slack, 0.0);
  }

  /// Windows of single points. Where a point has not moved its window is as it was.
  Gain Widen(double step) {
    windows_.resize(path_.size());
    made_for_.resize(path_.size());
    const std::vector<double> steps = LeanSteps(step);
    for (size_t t = 0; t < path_.size(); ++t) {
      WindowSpan span{step, steps};
      if (!options_.max_lean.empty())
        for (double& own : span.others) own = std::min(own, Slack(t));
      Window now{span, path_[t].freedoms, path_[t].genetic};
      if (made_for_[t] == now) continue;
      windows_[t] = MakeLayer(
          scorers_[t], WindowSeeds(scorers_[t], genetic_[t], path_[t], span, !options_.all_revolutions),
          options_.all_revolutions);
      made_for_[t] = std::move(now);
    }
    return Search(windows_);
  }

  /// The leans of the whole path; not where some point of it must stay.
  Gain Shift(double step) {
    if (std::ranges::any_of(path_, &PathNode::frozen)) return Gain::kNone;
    const std::vector<FreedomValues> shifts = LeanShifts(LeanSteps(step));
    const WindowSpan span{step, std::vector<double>(shifts[0].size() - 1, 0.0)};
    std::vector<Layer> layers(path_.size());
    for (size_t t = 0; t < path_.size(); ++t)
      layers[t] = MakeLayer(scorers_[t], ShiftedSeeds(scorers_[t], path_[t], shifts, span),
                            options_.all_revolutions, static_cast<int>(shifts.size()));
    return Search(layers);
  }

  /// Takes the best way through the layers where it is better than the path.
  Gain Search(const std::vector<Layer>& layers) {
    const double before = PathCost(path_, options_.rule, options_.max_step, options_.closed),
                 worst_before = Worst(path_);
    LadderProblem problem{layers, options_.rule, {}, false, false, options_.stop, {}};
    problem.max_step = options_.max_step;
    if (options_.worst_first) problem.most = worst_before;
    const std::optional<Sequence> found = SearchOnce(problem, options_);
    if (!found) return Gain::kNone;
    const bool less_worst = options_.worst_first && WorstOf(layers, *found) < worst_before;
    if (!(found->cost < before) && !less_worst) return Gain::kNone;
    for (size_t t = 0; t < path_.size(); ++t) {
      const size_t node = found->nodes[t];
      path_[t].freedoms = FreedomsOf(layers[t], node);
      path_[t].q = layers[t].joints.At(node);
      path_[t].objective = layers[t].objective[node];
      path_[t].genetic = layers[t].genetic[node];
    }
    return std::abs(before - found->cost) < 1e-6 * before ? Gain::kLittle : Gain::kMuch;
  }

  std::span<const PointScorer> scorers_;
  std::span<const PointOptimum> genetic_;
  const RefineOptions& options_;
  std::span<PathNode> path_;
  /// What a window depends on.
  struct Window {
    WindowSpan span;
    FreedomValues at;
    bool genetic;

    bool operator==(const Window&) const = default;
  };
  std::vector<std::optional<Window>> made_for_;
  std::vector<Layer> windows_;  ///< of these
};

}  // namespace

void RefinePath(std::span<const PointScorer> scorers, std::span<const PointOptimum> genetic,
                const RefineOptions& options, std::span<PathNode> path) {
  Refiner(scorers, genetic, options, path).Run();
}

}  // namespace millpose
