// SPDX-License-Identifier: GPL-3.0-or-later
#include <set>

#include "tests/planning/pose/problems.hpp"

namespace millpose {
namespace {

/// A lean of the tool axis about the nominal tool's x or y, tip held: a second and third freedom.
class Lean final : public Freedom {
 public:
  Lean(int axis, double most) : axis_(axis), most_(most) {}
  std::string Name() const override { return "lean"; }
  double Lower() const override { return -most_; }
  double Upper() const override { return most_; }
  bool Periodic() const override { return false; }
  Pose Apply(const Pose& X_WT, double value) const override {
    Pose moved = X_WT;
    moved.linear() =
        X_WT.linear() * Eigen::AngleAxisd(value, Eigen::Vector3d::Unit(axis_)).toRotationMatrix();
    return moved;
  }

 private:
  int axis_;
  double most_;
};

PoseProblem WithLeans(int leans) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  for (int axis = 0; axis < leans; ++axis)
    problem.freedoms.push_back(std::make_shared<Lean>(axis, DegToRad(10)));
  return problem;
}

TEST(CandidateTable, HoldsEveryAdmissibleCandidateOfItsGridOnce) {
  const PoseProblem problem = WithLeans(1);
  const PointScorer scorer(problem, PanelPoint(120, -80), Eigen::Vector3d::UnitZ());
  const CandidateTable table = CandidateTable::OfStep(scorer, DegToRad(7));
  EXPECT_EQ(table.line_length(), 52);  // of a whole turn; the lean has three intervals, so four values
  EXPECT_EQ(table.settings(), 52u * 4);
  EXPECT_EQ(table.stride(), 4u);
  std::set<std::pair<size_t, int>> held;
  for (const CandidateTable::Entry& entry : table.entries()) {
    EXPECT_TRUE(held.emplace(entry.setting, entry.branch).second);
    const Candidate alone = scorer.ScoreOne(table.Setting(entry.setting), entry.branch);
    EXPECT_EQ(alone.obstacle, Infeasibility::kNone);
    EXPECT_EQ(alone.objective, entry.objective);
    EXPECT_EQ(alone.q, entry.q);
  }
  size_t admissible = 0;
  FreedomValues before;
  for (size_t k = 0; k < table.settings(); ++k) {
    const FreedomValues setting = table.Setting(k);
    EXPECT_LT(before, setting);
    before = setting;
    for (int branch = 0; branch < 8; ++branch)
      admissible += scorer.ScoreOne(setting, branch).obstacle == Infeasibility::kNone;
  }
  EXPECT_EQ(admissible, table.entries().size());
}

TEST(CandidateTable, OfASizeHasAsManyValuesOfEveryFreedom) {
  const PoseProblem one = WithLeans(0), three = WithLeans(2);
  const PointScorer a(one, PanelPoint(0, 0), Eigen::Vector3d::UnitZ()),
      b(three, PanelPoint(0, 0), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(CandidateTable::OfSize(a, 64).settings(), 64u);
  EXPECT_EQ(CandidateTable::OfSize(b, 64).settings(), 64u);
  EXPECT_EQ(CandidateTable::OfSize(b, 3).settings(), 8u);  // at least two
  EXPECT_EQ(CandidateTable::OfSize(b, 64).Setting(63)[2], DegToRad(10));
}

// The ladder search's grid, refined, against the judge's.
TEST(RefineTable, GivesTheJudgesOptimumFromAGridOfADegree) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  RandomStream stream(12, 0);
  for (int k = 0; k < 40; ++k) {
    const MillingPoint point = PanelPoint(stream.Uniform(-450, 450), stream.Uniform(-300, 300),
                                          stream.Uniform(1600, 2100), stream.Uniform(800, 1400));
    const PointScorer scorer(problem, point, Eigen::Vector3d::UnitZ());
    const PointOptimum judge = ExhaustiveSearch(scorer, DegToRad(0.05));
    const PointOptimum refined = RefineTable(scorer, CandidateTable::OfStep(scorer, DegToRad(1)));
    ASSERT_EQ(judge.found, refined.found);
    if (judge.found) {
      EXPECT_NEAR(refined.objective / judge.objective, 1, 1e-9) << k;
    }
  }
}

TEST(RefineTable, LooksAlongEveryLineOfATableOfTwoFreedoms) {
  const PoseProblem problem = WithLeans(1);
  const PointScorer scorer(problem, PanelPoint(50, 40), Eigen::Vector3d::UnitZ());
  const CandidateTable table = CandidateTable::OfStep(scorer, DegToRad(5));
  const PointOptimum best = RefineTable(scorer, table);
  ASSERT_TRUE(best.found);
  for (int i = 0; i < 720; ++i)
    for (int lean = 0; lean < 5; ++lean)
      for (int branch = 0; branch < 8; ++branch) {
        const Candidate other = scorer.ScoreOne({DegToRad(-180 + 0.5 * i), table.At(1, lean)}, branch);
        if (other.obstacle != Infeasibility::kNone) continue;
        EXPECT_GE(other.objective, best.objective * (1 - 1e-12));
      }
}

// What the genetic algorithm is for: more freedoms than a table can hold finely.
TEST(GeneticSearch, BeatsTheRefinedTableWhereThereAreSeveralFreedoms) {
  for (const int leans : {1, 2}) {
    const PoseProblem problem = WithLeans(leans);
    RandomStream stream(13, 0);
    double genetic = 0, table = 0;
    int found = 0;
    for (uint64_t k = 0; k < 100; ++k) {
      const MillingPoint point = PanelPoint(stream.Uniform(-450, 450), stream.Uniform(-300, 300),
                                            stream.Uniform(1500, 2200), stream.Uniform(700, 1500));
      const PointScorer scorer(problem, point, Eigen::Vector3d::UnitZ());
      const GeneticOptions options;
      const PointOptimum refined = RefineTable(scorer, CandidateTable::OfSize(scorer, options.table));
      const PointOptimum best = GeneticSearch(scorer, problem, options, RandomStream(3, k));
      if (!best.found || !refined.found) continue;
      ++found;
      genetic += best.objective;
      table += refined.objective;
    }
    EXPECT_GT(found, 80);
    EXPECT_LT(genetic, 0.999 * table) << leans << " leans";
  }
}

}  // namespace
}  // namespace millpose
