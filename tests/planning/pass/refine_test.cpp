// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/refine_windows.hpp"
#include "planning/ladder/table_layer.hpp"
#include "tests/planning/pass/rough_row.hpp"
#include "tests/planning/pose/lean_problems.hpp"

namespace millpose {
namespace {

void ExpectSame(const std::vector<NodeSeed>& a, const std::vector<NodeSeed>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].freedoms, b[i].freedoms);
    EXPECT_EQ(a[i].branch, b[i].branch);
    EXPECT_EQ(a[i].candidate.obstacle, b[i].candidate.obstacle);
    EXPECT_EQ(a[i].candidate.objective, b[i].candidate.objective);
    EXPECT_EQ(a[i].candidate.q, b[i].candidate.q);
  }
}

TEST(WindowSeeds, AreThoseOfANodeThatIsScoredAgain) {
  for (const PoseProblem& problem : {MakeProblem(Kr500R2830()), LeaningProblem()}) {
    const PointScorer scorer(problem, PanelPoint(100, 50), Eigen::Vector3d::UnitZ());
    const CandidateTable table = CandidateTable::OfSize(scorer, 300);
    ASSERT_GT(table.entries().size(), 50u);
    const WindowSpan span{DegToRad(0.5), std::vector<double>(problem.freedoms.size() - 1, DegToRad(1))};
    for (size_t i = 0; i < table.entries().size(); i += 5) {
      const CandidateTable::Entry& entry = table.entries()[i];
      const PathNode node{table.Setting(entry.setting), entry.branch, entry.q, entry.objective};
      ExpectSame(WindowSeeds(scorer, {}, node, span, true), WindowSeeds(scorer, {}, node, span, false));
    }
  }
}

/// RefinePath with every window made anew.
void RefinePlainly(const RoughRow& row, const RefineOptions& options, std::vector<PathNode>& path) {
  for (double step = options.first_step / kHalfWindow; step >= options.last_step; step /= kHalfWindow) {
    for (int repeat = 0; repeat < 4; ++repeat) {
      std::vector<Layer> layers;
      for (size_t t = 0; t < path.size(); ++t)
        layers.push_back(
            MakeLayer(row.scorers[t], WindowSeeds(row.scorers[t], {}, path[t], {step, {}}, false), false));
      const double before = PathCost(path, options.rule, {}, false);
      const LadderProblem problem{layers, options.rule, {}, false, false, {}, {}};
      const Sequence found = SearchOpen(problem);
      if (!(found.cost < before)) break;
      for (size_t t = 0; t < path.size(); ++t) {
        const size_t node = found.nodes[t];
        path[t].freedoms = FreedomsOf(layers[t], node);
        path[t].q = layers[t].joints.At(node);
        path[t].objective = layers[t].objective[node];
      }
      if (before - found.cost < 1e-6 * before) break;
    }
  }
}

// Windows are kept while their points stand, and follow those that move.
TEST(RefinePath, FindsWhatWindowsMadeAnewFind) {
  RoughRow row(20, 10, [](int t) { return DegToRad(t % 3 == 0 ? 1.0 : 0.0); });
  RefineOptions options;
  options.rule.motion_weight = 1e-5;
  options.rule.max_step = Joints::Constant(DegToRad(5));
  options.first_step = DegToRad(1);
  options.last_step = DegToRad(0.002);
  std::vector<PathNode> path = row.path, plainly = row.path;
  RefinePath(row.scorers, std::vector<PointOptimum>(path.size()), options, path);
  RefinePlainly(row, options, plainly);
  double moved = 0;
  for (size_t t = 0; t < path.size(); ++t) {
    EXPECT_EQ(path[t].freedoms, plainly[t].freedoms) << t;
    EXPECT_EQ(path[t].q, plainly[t].q) << t;
    moved = std::max(moved, std::abs(path[t].freedoms[0] - row.path[t].freedoms[0]));
  }
  EXPECT_GT(moved, DegToRad(1.5)) << "beyond one window";
}

}  // namespace
}  // namespace millpose
