// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/pass_context.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "planning/ladder/table_layer.hpp"
#include "planning/pass/lean_courses.hpp"
#include "planning/pose/lean_problem.hpp"

namespace millpose {
namespace {

/// Whether a value is better than all of a table.
bool IsBeyond(double objective, const CandidateTable* table) {
  return !table || std::all_of(table->entries().begin(), table->entries().end(),
                               [&](const auto& entry) { return objective < entry.objective; });
}

/// What the nodes of all points take at most, bytes.
double BytesOfNodes(const PassContext& context, bool all_revolutions) {
  // Of a node in Layer, CandidateGraph and the rows of a search.
  constexpr double kNode = 120;
  const AdmissibleBounds& bounds = context.problem.bounds;
  double nodes = 0;
  for (const auto& table : context.tables) {
    if (!table) continue;
    if (!all_revolutions)
      nodes += static_cast<double>(table->entries().size());
    else
      for (const CandidateTable::Entry& entry : table->entries())
        nodes += CountRevolutions(entry.q, bounds.lower, bounds.upper);
  }
  return kNode * nodes;
}

/// The admissible candidates of every point.
std::vector<Layer> MakeLayers(const PassContext& context, bool all_revolutions) {
  CheckMemory(context, BytesOfNodes(context, all_revolutions));
  std::vector<Layer> layers(context.scorers.size());
  const std::vector<size_t> leans = ChooseLeans(context);
  const bool leaning = HasLean(context.problem);
  const int courses = leaning ? static_cast<int>(leans.size()) : 1;
  ParallelFor(layers.size(), context.threads, context.stop, [&](size_t t) {
    const PointScorer& scorer = context.scorers[t];
    std::vector<NodeSeed> seeds;
    const CandidateTable* table = context.tables[t].get();
    if (table && leaning) seeds = LeaningSeeds(context, t, leans);
    const auto add = [&](const PointOptimum& optimum, bool genetic) {
      if (!optimum.found) return;
      seeds.push_back(
          {optimum.freedoms, scorer.ScoreOne(optimum.freedoms, optimum.branch), optimum.branch, genetic});
    };
    const PointOptimum& genetic = context.genetic[t];
    // At a lean of its own no course would join it; the windows of the refinement take it in (refine.hpp).
    if (!leaning) add(genetic, genetic.found && IsBeyond(genetic.objective, table));
    // Intervals narrower than the grid: better the finer table's answer than a skipped point.
    const bool none = seeds.empty() && (!table || table->entries().empty());
    if (none && !leaning) add(context.optima[t], false);
    layers[t] = table && !leaning ? MakeLayer(scorer, *table, std::move(seeds), all_revolutions)
                                  : MakeLayer(scorer, std::move(seeds), all_revolutions, courses);
    // Bands bound how the tool turns as the arm turns it.
    if (context.along) layers[t].R_WT = scorer.problem().X_WB.linear().transpose() * layers[t].R_WT;
  });
  return layers;
}

}  // namespace

void CheckMemory(const PassContext& context, double bytes) {
  if (bytes <= context.memory) return;
  throw InputError(
      {},
      fmt::format("path.rotation_step_deg: given {:.6g}; the candidates of a pass of {} points would take "
                  "more than {:.4g} MB; allowed: half of the machine's memory, shared by the passes that "
                  "are planned at once: {:.4g} MB; give a larger step, shorter passes, narrower "
                  "limits.joints_deg or fewer --threads",
                  RadToDeg(context.options.rotation_step), context.points.size(), std::floor(bytes / 1e6),
                  std::floor(context.memory / 1e6)));
}

StepRule MakeRule(const PassContext& context, bool all_revolutions) {
  StepRule rule;
  rule.motion_weight = context.motion_weight;
  rule.modulo_revolutions = !all_revolutions;
  return rule;
}

PassChecks MakeChecks(const PassContext& context) {
  const PoseProblem& problem = context.problem;
  return {
      .world = context.world,
      .carrier = {problem.arm, problem.X_WB, problem.X_FT},
      .swept_resolution = context.options.swept_resolution,
      .rotates_first = problem.freedoms[0]->IsToolRotation(),
      .threads = context.threads,
      .stop = context.stop,
      .gouges = {{problem.arm, problem.X_WB, problem.X_FT}, problem},
      .along = context.along ? std::span<const PlaceAlong>(*context.along) : std::span<const PlaceAlong>()};
}

std::vector<MillingPoint> StepPointsOf(const PassContext& context, size_t first, size_t count) {
  std::vector<MillingPoint> points = StepPoints(context.problem, context.points.subspan(first, count));
  for (size_t i = 0; context.along && i < count; ++i)
    points[i] = OnPart((*context.along)[first + i], points[i]);
  return points;
}

std::shared_ptr<CandidateGraph> MakeGraph(const PassContext& context, bool all_revolutions) {
  return std::make_shared<CandidateGraph>(MakeChecks(context), MakeLayers(context, all_revolutions),
                                          StepBoundsAlong(context.options.steps, context.problem.arm,
                                                          StepPointsOf(context, 0, context.points.size())),
                                          context.verdicts);
}

LadderProblem MakeProblem(const PassContext& context, const CandidateGraph& graph, bool all_revolutions) {
  // The band needs the one freedom to be the rotation (BandWidth).
  const auto& freedoms = context.problem.freedoms;
  const bool rotation = freedoms[0]->IsToolRotation(), banded = freedoms.size() == 1 && rotation;
  // Along a lane the rotation alone differs.
  const bool walls = banded || (rotation && HasLean(context.problem));
  return {.layers = graph.layers(),
          .rule = MakeRule(context, all_revolutions),
          .blocked = graph.barred(),
          .banded = banded,
          .walls = walls,
          .stop = context.stop,
          .break_before = context.break_before,
          .versions = graph.versions(),
          .max_step = graph.max_step()};
}

double MotionWeight(double share, std::span<const PointOptimum> optima) {
  std::vector<double> values;
  for (const PointOptimum& optimum : optima)
    if (optimum.found && optimum.objective > 0) values.push_back(optimum.objective);
  if (values.empty()) return share;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return share * *middle;
}

}  // namespace millpose
