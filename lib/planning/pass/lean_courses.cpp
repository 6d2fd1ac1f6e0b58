// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/lean_courses.hpp"

#include <algorithm>
#include <tuple>

#include "planning/pose/lean_problem.hpp"

namespace millpose {
namespace {

constexpr double kRotationStep = 4 * kRadPerDeg;  // with leans: the windows are finer
constexpr size_t kMostCourses = 5;
constexpr double kSameLean = 1e-12;  // rad

/// What a lean promises: the best candidates of each point, whether or not they can be joined.
struct Promise {
  size_t lean = 0, missing = 0;
  double worst = 0, sum = 0;
};

/// Which leans of a point go into the part, where the nominal one does; empty where that is clear: what other
/// leans do there is asked of the few poses that a search picks.
std::vector<char> GougingLeans(const PassContext& context, size_t t, size_t leans) {
  const PoseProblem& problem = context.problem;
  if (!problem.lean || !problem.lean->surface) return {};
  const auto gouges = [&](const MillingPoint& point) {
    return problem.lean->surface->Gouge(point.position, point.tool_axis) > 0;
  };
  if (!gouges(context.points[t])) return {};
  std::vector<char> gouging(leans);
  for (size_t j = 0; j < leans; ++j)
    gouging[j] = gouges(AtLean(problem, context.points[t], context.tables[t]->Setting(j)));
  return gouging;
}

std::vector<Promise> PromisesOf(const PassContext& context, size_t leans) {
  std::vector<Promise> promises(leans);
  for (size_t j = 0; j < leans; ++j) promises[j].lean = j;
  for (size_t t = 0; t < context.tables.size(); ++t) {
    if (!context.tables[t]) continue;
    std::vector<double> least(leans, std::numeric_limits<double>::infinity());
    const std::vector<char> gouging = GougingLeans(context, t, leans);
    for (const CandidateTable::Entry& entry : context.tables[t]->entries()) {
      const size_t lean = entry.setting % leans;
      if (gouging.empty() || !gouging[lean]) least[lean] = std::min(least[lean], entry.objective);
    }
    for (size_t j = 0; j < leans; ++j) {
      if (!std::isfinite(least[j])) {
        ++promises[j].missing;
        continue;
      }
      promises[j].worst = std::max(promises[j].worst, least[j]);
      promises[j].sum += least[j];
    }
  }
  return promises;
}

}  // namespace

double RotationStep(const PassContext& context) {
  const double step = context.options.rotation_step;
  return HasLean(context.problem) ? std::max(step, kRotationStep) : step;
}

size_t NominalSetting(const PoseProblem& problem, const CandidateTable& table) {
  for (size_t j = 0; j < table.stride(); ++j)
    if (IsNominalLean(problem, table.Setting(j))) return j;
  return 0;
}

std::vector<size_t> ChooseLeans(const PassContext& context) {
  const auto table =
      std::ranges::find_if(context.tables, [](const auto& of) { return static_cast<bool>(of); });
  if (table == context.tables.end() || (*table)->stride() == 1) return {0};
  const size_t nominal = NominalSetting(context.problem, **table);
  std::vector<Promise> promises = PromisesOf(context, (*table)->stride());
  const auto key = [&](const Promise& p) {
    return std::tuple(p.missing, context.options.worst_first ? p.worst : 0.0, p.sum);
  };
  std::ranges::stable_sort(promises, {}, key);
  std::vector<size_t> leans{nominal};
  for (const Promise& promise : promises)
    if (promise.lean != nominal && leans.size() < kMostCourses) leans.push_back(promise.lean);
  return leans;
}

std::vector<NodeSeed> LeaningSeeds(const PassContext& context, size_t t, std::span<const size_t> leans) {
  std::vector<NodeSeed> seeds = SeedsOf(*context.tables[t], leans);
  std::erase_if(seeds, [](const NodeSeed& seed) { return seed.course == 0; });
  const PointScorer& scorer = context.scorers[t];
  const Freedom& rotation = *context.problem.freedoms[0];
  const double range = rotation.Upper() - rotation.Lower();
  const int count = std::max(1, static_cast<int>(std::ceil(range / context.options.rotation_step - 1e-9)));
  std::vector<FreedomValues> settings;
  for (int i = 0; i < count; ++i)
    settings.push_back(NominalFreedoms(context.problem, rotation.Lower() + i * (range / count)));
  std::vector<Candidate> candidates(8 * settings.size());
  scorer.Score(settings, candidates);
  for (size_t k = 0; k < candidates.size(); ++k)
    if (candidates[k].obstacle == Infeasibility::kNone)
      seeds.push_back({settings[k / 8], candidates[k], static_cast<int>(k % 8), false, 0});
  return seeds;
}

void DescendInLeans(PassContext& context, size_t t) {
  PointOptimum& own = context.optima[t];
  if (!HasLean(context.problem)) return;
  const PointOptimum& genetic = context.genetic[t];
  if (genetic.found && (!own.found || genetic.objective < own.objective))
    own = Descend(context.scorers[t], genetic);
}

std::vector<MillingPoint> StepPoints(const PoseProblem& problem, std::span<const MillingPoint> points) {
  std::vector<MillingPoint> of(points.begin(), points.end());
  if (HasLean(problem))
    for (MillingPoint& point : of) point = Upright(problem, point);
  return of;
}

std::vector<double> LeanBounds(const PoseProblem& problem, double per_mm,
                               std::span<const MillingPoint> points) {
  std::vector<double> bounds;
  if (!HasLean(problem)) return bounds;
  const std::vector<MillingPoint> of = StepPoints(problem, points);
  for (size_t t = 0; t < of.size(); ++t) bounds.push_back(per_mm * ToolWay(of[t], of[(t + 1) % of.size()]));
  return bounds;
}

bool LeansWithin(const FreedomValues& from, const FreedomValues& to, double most) {
  for (size_t d = 1; d < from.size(); ++d)
    if (std::abs(to[d] - from[d]) > most + kSameLean) return false;
  return true;
}

}  // namespace millpose
