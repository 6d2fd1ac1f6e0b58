// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/refine_windows.hpp"

#include "planning/pose/interval_end.hpp"

namespace millpose {
namespace {

constexpr double kEndTolerance = 1e-12;  // rad
constexpr double kLeaningEnd = 1e-4;     // steps: with leans, of which every one has ends of its own

/// To which ends of admissible intervals are located.
double EndTolerance(const WindowSpan& span) {
  return span.others.empty() ? kEndTolerance : std::max(kEndTolerance, kLeaningEnd * span.step);
}

/// Settings around a centre, the first freedom running fastest.
std::vector<FreedomValues> Window(const PoseProblem& problem, const FreedomValues& centre,
                                  const WindowSpan& span) {
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

/// What a setting is known to be worth.
using Known = std::pair<FreedomValues, Candidate>;

/// The candidates on one branch.
std::vector<Candidate> ScoreOn(const PointScorer& scorer, const std::vector<FreedomValues>& settings,
                               int branch, const std::optional<Known>& known) {
  const size_t dimensions = settings.front().size();
  std::vector<Candidate> candidates(settings.size());
  std::vector<size_t> asked;
  for (size_t k = 0; k < settings.size(); ++k) {
    if (known && settings[k] == known->first)
      candidates[k] = known->second;
    else
      asked.push_back(k);
  }
  std::vector<double> lanes(kLanes * dimensions);
  ScoredBlock block;
  for (size_t first = 0; first < asked.size(); first += kLanes) {
    for (size_t l = 0; l < kLanes; ++l) {
      const FreedomValues& of = settings[asked[std::min(first + l, asked.size() - 1)]];  // the last fills up
      std::copy(of.begin(), of.end(), lanes.begin() + static_cast<std::ptrdiff_t>(l * dimensions));
    }
    scorer.ScoreBlock(lanes, 1u << (branch & 3), block);
    for (size_t l = 0; l < kLanes && first + l < asked.size(); ++l)
      candidates[asked[first + l]] = CandidateOf(block, branch, static_cast<int>(l));
  }
  return candidates;
}

/// Settings about a centre and what they are worth.
struct ScoredWindow {
  std::vector<FreedomValues> settings;
  std::vector<Candidate> candidates;
  double end_tolerance;

  ScoredWindow(const PointScorer& scorer, const FreedomValues& centre, const WindowSpan& span, int branch,
               const std::optional<Known>& known)
      : settings(Window(scorer.problem(), centre, span)),
        candidates(ScoreOn(scorer, settings, branch, known)),
        end_tolerance(EndTolerance(span)) {}

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
    const bool admissible = candidates[k].obstacle == Infeasibility::kNone;
    if (settings[k] != at.freedoms) add(settings[k], candidates[k]);
    for (const size_t beside : {k - 1, k + 1}) {
      if (!admissible || beside >= settings.size()) continue;
      if (candidates[beside].obstacle == Infeasibility::kNone) continue;
      if (!std::equal(settings[k].begin() + 1, settings[k].end(), settings[beside].begin() + 1)) continue;
      FreedomValues end = settings[k];
      int evaluations = 0;
      end[0] =
          IntervalEnd(scorer, settings[k], 0, at.branch, settings[beside][0], end_tolerance, evaluations);
      if (end != settings[k]) add(end, scorer.ScoreOne(end, at.branch));
    }
  }
}

}  // namespace

std::vector<NodeSeed> WindowSeeds(const PointScorer& scorer, const PointOptimum& genetic, const PathNode& at,
                                  const WindowSpan& span, bool known) {
  if (at.frozen) return {{at.freedoms, scorer.ScoreOne(at.freedoms, at.branch), at.branch, at.genetic}};
  std::vector<NodeSeed> seeds;
  seeds.reserve(2 * kHalfWindow + 4);
  std::optional<Known> own;
  if (known) own = Known{at.freedoms, {Infeasibility::kNone, at.objective, 0, at.q}};
  const ScoredWindow window(scorer, at.freedoms, span, at.branch, own);
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

std::vector<FreedomValues> LeanShifts(const std::vector<double>& steps) {
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

std::vector<NodeSeed> ShiftedSeeds(const PointScorer& scorer, const PathNode& at,
                                   const std::vector<FreedomValues>& shifts, const WindowSpan& span) {
  std::vector<NodeSeed> seeds;
  seeds.push_back({at.freedoms, scorer.ScoreOne(at.freedoms, at.branch), at.branch, at.genetic});
  for (size_t course = 0; course < shifts.size(); ++course) {
    FreedomValues centre = at.freedoms;
    for (size_t d = 1; d < centre.size(); ++d) {
      const Freedom& freedom = *scorer.problem().freedoms[d];
      centre[d] = std::clamp(centre[d] + shifts[course][d], freedom.Lower(), freedom.Upper());
    }
    AddWindow(scorer, at, ScoredWindow(scorer, centre, span, at.branch, std::nullopt),
              static_cast<int>(course), seeds);
  }
  return seeds;
}

}  // namespace millpose
