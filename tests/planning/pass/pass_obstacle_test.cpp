// SPDX-License-Identifier: GPL-3.0-or-later
// Passes with something in the way.
#include "tests/planning/pass/pass_problem.hpp"

namespace millpose {
namespace {

TEST(PlanPass, GoesRoundWhatIsInTheWay) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const Pass pass = Row(-60, 60, 24);
  const PassResult before = PlanPass(problem, World(EmptyCell(problem)), {pass}, Options(), {.threads = 2});
  const World world(CellWithBallAt(problem, before, 12, 30));
  ASSERT_TRUE(Checker(world).At(before.points[12].q, Phase::kCutting).has_value());
  const PassResult result = PlanPass(problem, world, {pass}, Options(), {.threads = 2});
  ExpectSound(problem, Options(), pass, result);
  EXPECT_GT(result.nodes_pruned, 0);
  EXPECT_GT(result.poses_checked, 0);
  double objective = 0, objective_before = 0;
  Checker checker(world);
  for (size_t t = 0; t < pass.points.size(); ++t) {
    ASSERT_EQ(result.points[t].skip, Infeasibility::kNone) << t << result.points[t].detail;
    EXPECT_FALSE(checker.At(result.points[t].q, Phase::kCutting).has_value());
    objective += result.points[t].objective;
    objective_before += before.points[t].objective;
  }
  for (const Segment& piece : result.pieces) {
    for (int t = piece.first; t < piece.last; ++t) {
      EXPECT_FALSE(checker.Between(result.points[t].q, result.points[t + 1].q, Phase::kCutting).has_value());
    }
  }
  EXPECT_GT(objective, objective_before);  // the way round costs stiffness
}

TEST(PlanPass, SaysWhichBodiesBarAPoint) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  Pass pass = Row(-100, 100, 16);
  const PassResult before = PlanPass(problem, World(EmptyCell(problem)), {pass}, Options(), {.threads = 2});
  Cell cell = EmptyCell(problem);
  Body spindle{
      .name = "spindle", .body_class = BodyClass::kSpindle, .mount = Mount::kTool, .shape = Cylinder{8, 200}};
  spindle.X_MG.translation().z() = 200;
  Body rod{.name = "rod", .body_class = BodyClass::kFixture, .mount = Mount::kWorld, .shape = Sphere{2}};
  rod.X_MG.translation() = pass.points[6].position + 200 * pass.points[6].tool_axis;
  cell.bodies = {spindle, rod};
  const PassResult result = PlanPass(problem, World(cell), {pass}, Options(), {.threads = 2});
  ExpectSound(problem, Options(), pass, result);
  EXPECT_EQ(result.points[6].skip, Infeasibility::kInterference);
  EXPECT_NE(result.points[6].detail.find("spindle"), std::string::npos) << result.points[6].detail;
  EXPECT_NE(result.points[6].detail.find("rod"), std::string::npos) << result.points[6].detail;
  EXPECT_EQ(result.points[0].skip, Infeasibility::kNone);
  EXPECT_EQ(result.points[15].skip, Infeasibility::kNone);
}

}  // namespace
}  // namespace millpose
