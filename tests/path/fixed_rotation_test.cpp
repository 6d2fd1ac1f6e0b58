// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/fixed_rotation.hpp"

#include "stiffness/compliance.hpp"
#include "tests/path/pass_problem.hpp"

namespace millpose {
namespace {

FixedRotationOptions FixedOptions(bool worst_first) {
  const PathOptions path = Options();
  return {path.rotation_step, path.steps, path.swept_resolution, worst_first, 2, {}, {}};
}

/// Two rows of panel points that mill up and down in turns.
std::vector<Pass> Rows() {
  std::vector<Pass> rows{Row(-150, 150, 25, 0), Row(-150, 150, 25, 150)};
  for (Pass& row : rows)
    for (MillingPoint& point : row.points)
      point.engagement = {20 * point.feed - 10 * point.normal, 8, 1, CutSide::kUp};
  return rows;
}

std::vector<PassResult> Plan(const PoseProblem& problem, const World& world, const std::vector<Pass>& rows,
                             bool worst_first) {
  PathOptions options = Options();
  options.worst_first = worst_first;
  std::vector<PassResult> planned;
  for (size_t i = 0; i < rows.size(); ++i)
    planned.push_back(PlanPass(problem, world, rows[i], static_cast<int>(i), 25 * i, options, 2, {}));
  return planned;
}

double Worst(const std::vector<PointFigures>& figures) {
  double worst = 0;
  for (const PointFigures& point : figures) worst = std::max(worst, point.objective);
  return worst;
}

double Sum(const std::vector<PointFigures>& figures) {
  double sum = 0;
  for (const PointFigures& point : figures) sum += point.objective;
  return sum;
}

TEST(FixedRotation, APlanIsNeverWorseByItsOwnCriterion) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  problem.objective = MakeObjective("surface_error", {});
  const World world(EmptyCell(problem));
  const std::vector<PassResult> planned = Plan(problem, world, Rows(), true);
  const FixedComparison found = CompareWithFixed(Stations(world, problem), planned, FixedOptions(true));
  ASSERT_EQ(found.plan.size(), 50u);
  ASSERT_EQ(found.job.size(), 50u) << found.job_in_the_way;
  ASSERT_EQ(found.passes.size(), 50u) << found.passes_in_the_way;
  EXPECT_LE(Worst(found.plan), Worst(found.passes) * (1 + 2e-6));
  EXPECT_LE(Worst(found.passes), Worst(found.job));
  EXPECT_LT(Sum(found.plan), Sum(found.job));
}

TEST(FixedRotation, IsTheBestOfAllThatServeEveryPoint) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  problem.objective = MakeObjective("surface_error", {});
  const World world(EmptyCell(problem));
  const std::vector<Pass> rows = Rows();
  const std::vector<PassResult> planned = Plan(problem, world, rows, false);
  const FixedComparison found = CompareWithFixed(Stations(world, problem), planned, FixedOptions(true));
  double best = std::numeric_limits<double>::infinity();
  for (int r = -90; r < 90; ++r) {
    const double rotation = r * DegToRad(2);
    double job = 0;
    for (const Pass& row : rows) {
      double least = std::numeric_limits<double>::infinity();
      for (int branch = 0; branch < 8; ++branch) {
        double worst = 0;
        for (const MillingPoint& point : row.points) {
          const Candidate candidate =
              PointScorer(problem, point, row.rotation_reference).ScoreOne({rotation}, branch);
          worst = candidate.obstacle == Obstacle::kNone ? std::max(worst, candidate.objective)
                                                        : std::numeric_limits<double>::infinity();
          if (!std::isfinite(worst)) break;
        }
        least = std::min(least, worst);
      }
      job = std::max(job, least);
    }
    best = std::min(best, job);
  }
  ASSERT_FALSE(found.job.empty()) << found.job_in_the_way;
  EXPECT_NEAR(Worst(found.job) / best, 1, 1e-9);
  // Its figures are those of its poses.
  const Pass& row = rows[0];
  Eigen::Vector3d force = problem.X_WB.linear().transpose() * row.points[0].engagement.force;
  const PlannedPoint& planned_point = planned[0].points[0];
  const Eigen::Matrix3d c =
      Compliance(Jacobian(problem.arm, planned_point.q, problem.X_FT.translation()), problem.arm.stiffness)
          .topLeftCorner<3, 3>();
  EXPECT_NEAR(found.plan[0].length, (c * force).norm(), 1e-12);
}

TEST(FixedRotation, SaysWhatIsInTheWay) {
  PoseProblem problem = MakeProblem(Kr500R2830());
  const World world(EmptyCell(problem));
  const std::vector<PassResult> planned = Plan(problem, world, {Row(-60, 60, 8)}, false);
  const double middle = planned[0].points[4].q[4];
  // Axis 5 has to stay where only a few rotations bring it, and not the same ones at both ends.
  problem.bounds.lower[4] = middle - 1e-3;
  problem.bounds.upper[4] = middle + 1e-3;
  problem.bounds.lower[0] = planned[0].points[4].q[0] - 1e-3;
  problem.bounds.upper[0] = planned[0].points[4].q[0] + 1e-3;
  const FixedComparison found = CompareWithFixed(Stations(world, problem), planned, FixedOptions(false));
  EXPECT_TRUE(found.job.empty());
  EXPECT_TRUE(found.passes.empty());
  EXPECT_NE(found.job_in_the_way.find("points: "), std::string::npos) << found.job_in_the_way;
  EXPECT_NE(found.passes_in_the_way.find("pass 0"), std::string::npos) << found.passes_in_the_way;
}

}  // namespace
}  // namespace millpose
