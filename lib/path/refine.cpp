// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/refine.hpp"

#include "base/parallel.hpp"
#include "path/worst_then_sum.hpp"
#include "pose/interval_end.hpp"

namespace millpose {
namespace {

constexpr int kHalfWindow = 4;           // steps to either side
constexpr double kEndTolerance = 1e-12;  // rad
constexpr double kLeaningEnd = 1e-4;     // steps: with leans, of which every one has ends of its own

/// What a window spans to either side of a node: steps in the first freedom, and one in each other.
struct Span {
  double step;                 ///< rad
  std::vector<double> others;  ///< rad or mm

  /// To which ends of admissible intervals are located.
  double EndTolerance() const {
    return others.empty() ? kEndTolerance : std::max(kEndTolerance, kLeaningEnd * step);
  }
};

/// Settings around a centre, the first freedom running fastest.
std::vector<FreedomValues> Window(const PoseProblem& problem, const FreedomValues& centre, const Span& span) {
  std::vector<FreedomValues> settings{centre};
  const auto spread = [&](size_t d, int half, double step) {
    const Freedom& freedom = *problem.freedoms[d];
    std::vector<FreedomValues> more;
    for (const FreedomValues& setting : settings) {
      for (int i = -half; i <= half; ++i) {
        const double value = centre[d] + i * step;
        if (!freedom.Periodic() && (value < freedom.Lower() || value > freedom.Upper())) continue;
        more.push_back(setting);
        more.back()[d] = value;
      }
    }
    settings = std::move(more);
  };
  for (size_t d = 1; d < centre.size(); ++d) spread(d, span.others[d - 1] > 0 ? 1 : 0, span.others[d - 1]);
  spread(0, kHalfWindow, span.step);
  return settings;
}

/// The candidates on one branch.
std::vector<Candidate> ScoreOn(const PointScorer& scorer, const std::vector<FreedomValues>& settings,
                               int branch) {
  const size_t dimensions = settings.front().size();
  std::vector<double> lanes(kLanes * dimensions);
  std::vector<Candidate> candidates;
  ScoredBlock block;
  for (size_t first = 0; first < settings.size(); first += kLanes) {
    for (size_t l = 0; l < kLanes; ++l) {
      const FreedomValues& of = settings[std::min(first + l, settings.size() - 1)];  // the last fills up
      std::copy(of.begin(), of.end(), lanes.begin() + static_cast<std::ptrdiff_t>(l * dimensions));
    }
    scorer.ScoreBlock(lanes, 1u << (branch & 3), block);
    for (size_t l = 0; l < kLanes && first + l < settings.size(); ++l)
      candidates.push_back(CandidateOf(block, branch, static_cast<int>(l)));
  }
  return candidates;
}

/// Settings about a centre and what they are worth.
struct ScoredWindow {
  std::vector<FreedomValues> settings;
  std::vector<Candidate> candidates;
  double end_tolerance;

  ScoredWindow(const PointScorer& scorer, const FreedomValues& centre, const Span& span, int branch)
      : settings(Window(scorer.problem(), centre, span)),
        candidates(ScoreOn(scorer, settings, branch)),
        end_tolerance(span.EndTolerance()) {}

  /// At `freedoms`; scored now where these are none of the settings.
  Candidate At(const PointScorer& scorer, const FreedomValues& freedoms, int branch) const {
    const auto found = std::ranges::find(settings, freedoms);
    return found == settings.end() ? scorer.ScoreOne(freedoms, branch) : candidates[found - settings.begin()];
  }
};

/// A window as nodes of a course; along the first freedom, also the ends of the intervals that lie between
/// two neighbours.
void AddWindow(const PointScorer& scorer, const PathNode& at, const ScoredWindow& window, int course,
               std::vector<NodeSeed>& seeds) {
  const auto add = [&](const FreedomValues& freedoms, const Candidate& candidate) {
    seeds.push_back({freedoms, candidate, at.branch, false, course});
  };
  const auto& [settings, candidates, end_tolerance] = window;
  for (size_t k = 0; k < settings.size(); ++k) {
    const bool admissible = candidates[k].obstacle == Obstacle::kNone;
    if (settings[k] != at.freedoms) add(settings[k], candidates[k]);
    for (const size_t beside : {k - 1, k + 1}) {
      if (!admissible || beside >= settings.size()) continue;
      if (candidates[beside].obstacle == Obstacle::kNone) continue;
      if (!std::equal(settings[k].begin() + 1, settings[k].end(), settings[beside].begin() + 1)) continue;
      FreedomValues end = settings[k];
      int evaluations = 0;
      end[0] =
          IntervalEnd(scorer, settings[k], 0, at.branch, settings[beside][0], end_tolerance, evaluations);
      if (end != settings[k]) add(end, scorer.ScoreOne(end, at.branch));
    }
  }
}

/// The nodes that a path may take at one point, all in one course.
std::vector<NodeSeed> WindowSeeds(const PointScorer& scorer, const PointOptimum& genetic, const PathNode& at,
                                  const Span& span) {
  if (at.frozen) return {{at.freedoms, scorer.ScoreOne(at.freedoms, at.branch), at.branch, at.genetic}};
  std::vector<NodeSeed> seeds;
  seeds.reserve(2 * kHalfWindow + 4);
  const ScoredWindow window(scorer, at.freedoms, span, at.branch);
  seeds.push_back({at.freedoms, window.At(scorer, at.freedoms, at.branch), at.branch, at.genetic});
  AddWindow(scorer, at, window, 0, seeds);
  if (!at.genetic && genetic.found && genetic.branch == at.branch) {
    bool inside = std::abs(WrapToPi(genetic.freedoms[0] - at.freedoms[0])) <= kHalfWindow * span.step;
    for (size_t d = 1; d < at.freedoms.size(); ++d)
      inside = inside && std::abs(genetic.freedoms[d] - at.freedoms[d]) <= span.others[d - 1];
    if (inside)
      seeds.push_back({genetic.freedoms, scorer.ScoreOne(genetic.freedoms, at.branch), at.branch, true});
  }
  return seeds;
}

/// Shifts of all leans of a path together: none, and one step either way in each.
std::vector<FreedomValues> Shifts(const std::vector<double>& steps) {
  std::vector<FreedomValues> shifts{{0.0}};
  for (const double step : steps) {
    std::vector<FreedomValues> more;
    for (const double by : {0.0, -step, step})
      for (const FreedomValues& shift : shifts) {
        more.push_back(shift);
        more.back().push_back(by);
      }
    shifts = std::move(more);
  }
  return shifts;
}

/// The nodes of one point, a course for each shift. Where a lean ends at its range, neighbours come no
/// further apart by that.
std::vector<NodeSeed> ShiftedSeeds(const PointScorer& scorer, const PathNode& at,
                                   const std::vector<FreedomValues>& shifts, const Span& span) {
  std::vector<NodeSeed> seeds;
  seeds.push_back({at.freedoms, scorer.ScoreOne(at.freedoms, at.branch), at.branch, at.genetic});
  for (size_t course = 0; course < shifts.size(); ++course) {
    FreedomValues centre = at.freedoms;
    for (size_t d = 1; d < centre.size(); ++d) {
      const Freedom& freedom = *scorer.problem().freedoms[d];
      centre[d] = std::clamp(centre[d] + shifts[course][d], freedom.Lower(), freedom.Upper());
    }
    AddWindow(scorer, at, ScoredWindow(scorer, centre, span, at.branch), static_cast<int>(course), seeds);
  }
  return seeds;
}

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

  /// Windows of single points.
  Gain Widen(double step) {
    std::vector<Layer> layers(path_.size());
    const std::vector<double> steps = LeanSteps(step);
    for (size_t t = 0; t < path_.size(); ++t) {
      Span span{step, steps};
      if (!options_.max_lean.empty())
        for (double& own : span.others) own = std::min(own, Slack(t));
      layers[t] = MakeLayer(scorers_[t], WindowSeeds(scorers_[t], genetic_[t], path_[t], span),
                            options_.all_revolutions);
    }
    return Search(layers);
  }

  /// The leans of the whole path; not where some point of it must stay.
  Gain Shift(double step) {
    if (std::ranges::any_of(path_, &PathNode::frozen)) return Gain::kNone;
    const std::vector<FreedomValues> shifts = Shifts(LeanSteps(step));
    const Span span{step, std::vector<double>(shifts[0].size() - 1, 0.0)};
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
      path_[t].freedoms = layers[t].freedoms[node];
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
};

}  // namespace

void RefinePath(std::span<const PointScorer> scorers, std::span<const PointOptimum> genetic,
                const RefineOptions& options, std::span<PathNode> path) {
  Refiner(scorers, genetic, options, path).Run();
}

}  // namespace millpose
