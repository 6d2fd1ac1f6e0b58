// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/end_guard.hpp"

#include "tests/planning/pass/pass_problem.hpp"

namespace millpose {
namespace {

/// A ball at the wrist, and balls where it would come to, retracting from poses.
Cell CellAbove(const PoseProblem& problem, const std::vector<Joints>& poses) {
  Cell cell = EmptyCell(problem);
  cell.bodies.push_back({.name = "wrist",
                         .body_class = BodyClass::kLink,
                         .mount = Mount::kLink,
                         .link = 5,
                         .shape = Sphere{15}});
  const Carrier carrier{problem.arm, problem.X_WB, problem.X_FT};
  for (const Joints& q : poses) {
    Checker checker{World(EmptyCell(problem))};
    const Retract retract = FindRetract(checker, carrier, q, {problem.arm.lower, problem.arm.upper}, {});
    Body ball{.name = "ball", .body_class = BodyClass::kFixture, .mount = Mount::kWorld, .shape = Sphere{15}};
    ball.X_MG.translation() =
        (problem.X_WB * LinkFrames(problem.arm, retract.joints.back())[5]).translation();
    cell.bodies.push_back(ball);
  }
  return cell;
}

struct EndFixture {
  PoseProblem problem = MakeProblem(Kr500R2830());
  Pass pass = Row(-60, 60, 24);
  Carrier carrier{problem.arm, problem.X_WB, problem.X_FT};
  PathOptions options = Options();
  PassResult before = PlanPass(problem, World(EmptyCell(problem)), {pass}, options, {.threads = 2});

  bool Leaves(const World& world, const Joints& q, double share = 1) const {
    Checker checker(world, share);
    return CanLeave(checker, carrier, q, {});
  }
};

TEST(EndGuard, TakesAnotherPoseWhereAnEndCannotBeLeft) {
  EndFixture f;
  const World world(CellAbove(f.problem, {f.before.points[23].q}));
  const PassResult unguarded = PlanPass(f.problem, world, {f.pass}, f.options, {.threads = 2});
  ASSERT_FALSE(f.Leaves(world, unguarded.points[23].q));
  ASSERT_FALSE(f.Leaves(world, unguarded.points[23].q, kClearanceShares.back()));
  f.options.leave.emplace();
  const PassResult guarded = PlanPass(f.problem, world, {f.pass}, f.options, {.threads = 2});
  ExpectSound(f.problem, f.options, f.pass, guarded);
  ASSERT_EQ(guarded.pieces.size(), 1u);
  EXPECT_EQ(guarded.pieces[0].last, 23);
  EXPECT_TRUE(f.Leaves(world, guarded.points[23].q));
  EXPECT_TRUE(f.Leaves(world, guarded.points[0].q));
  EXPECT_GT((guarded.points[23].q - unguarded.points[23].q).norm(), DegToRad(1));
  double objective = 0, least = 0;
  for (size_t t = 0; t < 24; ++t) {
    objective += guarded.points[t].objective;
    least += unguarded.points[t].objective;
  }
  EXPECT_LT(objective, 1.2 * least);
}

TEST(EndGuard, ChangesNothingWhereTheEndsAreFree) {
  EndFixture f;
  const World world(CellAbove(f.problem, {f.before.points[12].q}));  // not an end
  const PassResult unguarded = PlanPass(f.problem, world, {f.pass}, f.options, {.threads = 2});
  ASSERT_FALSE(f.Leaves(world, unguarded.points[12].q));
  f.options.leave.emplace();
  const PassResult guarded = PlanPass(f.problem, world, {f.pass}, f.options, {.threads = 2});
  for (size_t t = 0; t < 24; ++t) EXPECT_EQ(guarded.points[t].q, unguarded.points[t].q) << t;
}

TEST(EndGuard, APointThatNoPoseLeavesEndsThePieceBeforeIt) {
  EndFixture f;
  // A plate over the last point that the spindle's holder would meet on its way out, in every rotation.
  Cell cell = EmptyCell(f.problem);
  Body holder{.name = "holder", .body_class = BodyClass::kSpindle, .mount = Mount::kTool, .shape = Sphere{4}};
  holder.X_MG.translation().z() = 60;
  Body stop{.name = "stop", .body_class = BodyClass::kFixture, .mount = Mount::kWorld, .shape = Sphere{4}};
  const MillingPoint& last = f.pass.points[23];
  stop.X_MG.translation() = last.position + 85 * last.tool_axis;
  cell.bodies = {holder, stop};
  const World world(cell);
  f.options.leave.emplace();
  const PassResult guarded = PlanPass(f.problem, world, {f.pass}, f.options, {.threads = 2});
  ExpectSound(f.problem, f.options, f.pass, guarded);
  ASSERT_EQ(guarded.pieces.size(), 1u);
  const auto end = static_cast<size_t>(guarded.pieces[0].last);
  EXPECT_LT(end, 23u);
  EXPECT_GT(end, 16u);
  EXPECT_TRUE(f.Leaves(world, guarded.points[end].q, kClearanceShares.back()));
  for (size_t t = end + 1; t < 24; ++t) {
    EXPECT_EQ(guarded.points[t].skip, Infeasibility::kAccess) << t;
    EXPECT_NE(guarded.points[t].detail.find("holder"), std::string::npos) << guarded.points[t].detail;
  }
}

}  // namespace
}  // namespace millpose
