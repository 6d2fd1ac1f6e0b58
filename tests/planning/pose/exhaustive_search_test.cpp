// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/planning/pose/admissible_reference.hpp"
#include "tests/planning/pose/problems.hpp"

namespace millpose {
namespace {

// Chen 2021 eq. 36 against the optimum of its own family (docs/genetic-algorithm.md).
TEST(ExhaustiveSearch, FindsThatPose1OfThePaperIsNearlyOptimal) {
  const PaperCase paper = MakePaperCase();
  const PointScorer scorer(paper.problem, paper.point, Eigen::Vector3d::UnitZ());
  const PointOptimum best = ExhaustiveSearch(scorer, DegToRad(0.25));
  ASSERT_TRUE(best.found);
  EXPECT_NEAR(best.objective, 2.5790e-4, 0.0002e-4);
  EXPECT_NEAR(RadToDeg(best.q[0]), -2.14, 0.05);
  EXPECT_NEAR(RadToDeg(best.q[1]), -64.61, 0.05);
  EXPECT_NEAR(RadToDeg(best.q[2]), 103.04, 0.05);
  // Pose 1 belongs to the family and is 0.17 % worse.
  const Matrix6 C = Compliance(Jacobian(paper.problem.arm, paper.pose1, paper.problem.X_FT.translation()),
                               paper.problem.arm.stiffness);
  const auto indices = IndicesInPlane(C.topLeftCorner<3, 3>(), paper.point.normal);
  const double pose1 = 0.5 * indices->lambda_t2 + 0.5 * indices->lambda_n;
  EXPECT_GT(pose1, best.objective);
  EXPECT_LT(pose1, 1.003 * best.objective);
}

TEST(ExhaustiveSearch, NoCandidateOfAFineGridIsBetter) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  RandomStream stream(11, 0);
  int on_bounds = 0;
  for (int k = 0; k < 6; ++k) {
    const MillingPoint point = PanelPoint(stream.Uniform(-450, 450), stream.Uniform(-300, 300));
    const PointScorer scorer(problem, point, Eigen::Vector3d::UnitZ());
    const PointOptimum best = ExhaustiveSearch(scorer, DegToRad(0.5));
    ASSERT_TRUE(best.found);
    EXPECT_EQ(ReferenceInfeasibility(problem, best.q), Infeasibility::kNone);
    EXPECT_EQ(best.objective, scorer.ScoreOne(best.freedoms, best.branch).objective);
    std::vector<FreedomValues> grid;
    for (int i = 0; i < 14400; ++i) grid.push_back({-kPi + i * kPi / 7200});
    std::vector<Candidate> candidates(8 * grid.size());
    scorer.Score(grid, candidates);
    for (const Candidate& candidate : candidates) {
      if (candidate.obstacle != Infeasibility::kNone) continue;
      EXPECT_GE(candidate.objective, best.objective * (1 - 1e-12));
    }
    const Joints room = (best.q - problem.bounds.lower).cwiseMin(problem.bounds.upper - best.q);
    if (room.minCoeff() < 1e-9) ++on_bounds;
  }
  EXPECT_GT(on_bounds, 0);  // the ends of admissible intervals are reached exactly
}

TEST(ExhaustiveSearch, SaysHowFarTheBestCandidateCame) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  const auto reason = [&](const MillingPoint& point) {
    const PointScorer scorer(problem, point, Eigen::Vector3d::UnitZ());
    const PointOptimum best = ExhaustiveSearch(scorer, DegToRad(1));
    EXPECT_FALSE(best.found);
    return best.reason;
  };
  EXPECT_EQ(reason(PanelPoint(0, 0, 6000)), Infeasibility::kUnreachable);
  problem.bounds.lower[0] = problem.bounds.upper[0] = DegToRad(100);
  EXPECT_EQ(reason(PanelPoint(0, 0)), Infeasibility::kLimit);
  problem = MakeProblem(Kr500R2830());
  problem.bounds.dexterity_min = 0.99;
  EXPECT_EQ(reason(PanelPoint(0, 0)), Infeasibility::kSingular);
}

}  // namespace
}  // namespace millpose
