// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/verify.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/economy.hpp"
#include "program/linuxcnc/linuxcnc.hpp"
#include "program/sinumerik/sinumerik.hpp"
#include "program/verify/arm_bodies.hpp"
#include "program/verify/corner.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {
namespace {

std::string Text(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings)
    text += fmt::format("{}:{}: {}\n", finding.file, finding.line, finding.message);
  return text;
}

class VerifyPost : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Post> post = SamplePost(GetParam());
  PostSettings settings = SampleSettings(GetParam());
  PlanResult plan = SamplePlan();
  MotionProgram program = MakeMotionProgram(plan);
  World world{SampleCell(plan)};
  VerifyOptions options = SampleOptions(plan);

  MotionProgram WrittenAndRead() const {
    const MotionProgram prepared = Prepared(program, GetParam(), settings, plan.arm);
    return post->Read(post->Write(prepared, plan.arm, settings), plan.arm, settings);
  }
};
INSTANTIATE_TEST_SUITE_P(Controllers, VerifyPost,
                         testing::Values("krl", "sinumerik", "sinumerik_euler", "linuxcnc",
                                         "linuxcnc_cartesian", "urscript"),
                         [](const auto& controller) { return controller.param; });

TEST_P(VerifyPost, ConfirmsWhatWasWritten) {
  options.interference = true;
  EXPECT_EQ(Text(Verify(WrittenAndRead(), world, &program, options, {.threads = 2})), "");
}

// Of a part of the approach that is shorter than a program's decimals only the stop would be left, or not
// even that.
TEST_P(VerifyPost, AnApproachIsNotCutInTwoForNothing) {
  for (const double more : {1e-7, 1e-5, 1e-3, 0.04, 0.06, 1.0}) {
    plan = SamplePlan({.lift = 5 + more});
    program = MakeMotionProgram(plan, SampleFeeds());
    EXPECT_EQ(Text(Verify(WrittenAndRead(), world, &program, options, {.threads = 2})), "") << more;
  }
}

TEST_P(VerifyPost, ConfirmsWithoutAPlan) {
  EXPECT_EQ(Text(Verify(WrittenAndRead(), world, nullptr, options, {.threads = 2})), "");
}

TEST_P(VerifyPost, SameForAnyNumberOfThreads) {
  MotionProgram read = WrittenAndRead();
  for (size_t i = 6; i < read.motions.size(); i += 3)
    read.motions[i].feed *= 3, read.motions[i].duration /= 3;
  const std::string one = Text(Verify(read, world, &program, options, {.threads = 1}));
  EXPECT_NE(one, "");
  EXPECT_EQ(one, Text(Verify(read, world, &program, options, {.threads = 4})));
}

TEST_P(VerifyPost, SeesAWorkpieceElsewhere) {
  // The program is right, the cell is another: the replay goes through the cell.
  Cell moved = SampleCell(plan);
  moved.X_WP.translation().x() += 0.05;
  EXPECT_NE(Text(Verify(WrittenAndRead(), World(moved), &program, options, {.threads = 2})), "");
}

TEST_P(VerifyPost, SeesAnotherTool) {
  Cell moved = SampleCell(plan);
  moved.X_FT.translation().x() += 0.05;
  const std::string text = Text(Verify(WrittenAndRead(), World(moved), &program, options, {.threads = 2}));
  // SINUMERIK takes the tool from the control's own data, so the program says nothing about it.
  EXPECT_EQ(text.empty(), ControllerOf(GetParam()) == "sinumerik") << text;
}

TEST_P(VerifyPost, SeesLimits) {
  options.upper[4] = 0.1;
  const std::string text = Text(Verify(WrittenAndRead(), world, &program, options, {.threads = 2}));
  EXPECT_NE(text.find("A5 at"), std::string::npos) << text;
}

TEST_P(VerifyPost, SeesInterference) {
  Cell narrow = SampleCell(plan);
  Body post_body;
  post_body.name = "post";
  post_body.X_MG.translation() = plan.X_WP.translation() + Eigen::Vector3d(-250, 0, 0);
  post_body.shape = Box{{60, 60, 60}};
  narrow.bodies.push_back(post_body);
  const std::string text = Text(Verify(WrittenAndRead(), World(narrow), nullptr, options, {.threads = 2}));
  EXPECT_NE(text.find("post"), std::string::npos) << text;
}

/// A pass along which the tool turns about its axis on a curve: by `bend`·k² at the k-th point.
PlanResult TurningPlan(double bend) {
  PlanResult plan = SamplePlan({.points = 60, .spacing = 0.5, .ring = false, .passes = 1});
  std::vector<PlannedPoint>& points = plan.passes[0].points;
  for (size_t i = 1; i < points.size(); ++i) {
    const double angle = bend * static_cast<double>(i * i);
    const Pose turn = plan.X_FT * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * plan.X_FT.inverse();
    Joints& q = points[i].q;
    q = InverseNear(plan.arm, ForwardFlange(plan.arm, q) * turn, Status(plan.arm, q), points[i - 1].q)
            .value();
  }
  plan.gaps.back().joints.front() = points.back().q;
  return plan;
}

TEST(Verify, WhatIsLeftOutAndWhatTheControlDoesStayWithinTheTolerance) {
  for (const double bend : {2e-6, 8e-6, 3e-5, 1.2e-4, 3e-4}) {
    const PlanResult plan = TurningPlan(bend);
    const MotionProgram planned = MakeMotionProgram(plan);
    const World world(SampleCell(plan));
    for (const std::string variant : {"linuxcnc", "linuxcnc_cartesian", "krl", "sinumerik"}) {
      // As the pipeline does it: LinuxCNC's writer adds what the control does between points.
      EconomyOptions economy;
      if (ControllerOf(variant) == "linuxcnc") economy.angle_tolerance -= kHalfwayAngle + kAngleMargin;
      const MotionProgram thinned = Economise(planned, economy).program;
      if (bend < 1e-4) {
        EXPECT_LT(thinned.motions.size(), planned.motions.size()) << variant << " " << bend;
      }
      const auto post = SamplePost(variant);
      const PostSettings settings = SampleSettings(variant);
      const MotionProgram prepared = Prepared(thinned, variant, settings, plan.arm);
      const MotionProgram read = post->Read(post->Write(prepared, plan.arm, settings), plan.arm, settings);
      std::string text;
      for (const Finding& finding : Verify(read, world, &planned, SampleOptions(plan), {.threads = 2}))
        if (finding.message.find("leaves the plan") != std::string::npos) text += finding.message + "\n";
      EXPECT_EQ(text, "") << variant << " " << bend;
    }
  }
}

TEST(Verify, HowEverTheToolTurnsItStaysWithinTheTolerance) {
  // 8 degrees a block, tilt and turn about the axis at once.
  PlanResult plan = SamplePlan({.points = 4, .ring = false, .passes = 1});
  std::vector<PlannedPoint>& points = plan.passes[0].points;
  for (size_t i = 1; i < points.size(); ++i) {
    const Pose turn =
        plan.X_FT *
        Eigen::AngleAxisd(8 * kRadPerDeg * static_cast<double>(i), Eigen::Vector3d(0.6, 0.48, 0.64)) *
        plan.X_FT.inverse();
    Joints& q = points[i].q;
    q = InverseNear(plan.arm, ForwardFlange(plan.arm, q) * turn, Status(plan.arm, q), points[i - 1].q)
            .value();
  }
  plan.gaps.back().joints.front() = points.back().q;
  const MotionProgram planned = MakeMotionProgram(plan);
  const World world(SampleCell(plan));
  const auto leaving = [&](const MotionProgram& written, const SinumerikPost& post,
                           const PostSettings& settings) {
    const MotionProgram read = post.Read(post.Write(written, plan.arm, settings), plan.arm, settings);
    std::string text;
    for (const Finding& finding : Verify(read, world, &planned, SampleOptions(plan), {.threads = 2}))
      if (finding.message.find("leaves the plan") != std::string::npos) text += finding.message + "\n";
    return text;
  };
  for (const FrameAxis axis : {FrameAxis::kZ, FrameAxis::kMinusX}) {
    for (const std::optional<bool> by_g_code :
         {std::optional<bool>(), std::optional(true), std::optional(false)}) {
      PostSettings settings = SampleSettings("sinumerik");
      settings.tool_axis = axis;
      SinumerikOptions options;
      options.ori_ipo_with_g_code = by_g_code;
      const SinumerikPost post(options);
      EXPECT_NE(leaving(planned, post, settings), "") << WordOf(kFrameAxisWords, axis);
      EXPECT_EQ(leaving(Prepared(planned, post, settings, plan.arm), post, settings), "");
    }
  }
}

TEST(Verify, CornersThatAreHardlyAnyMayBeRounded) {
  const PlanResult plan = SamplePlan();
  const MotionProgram program = MakeMotionProgram(plan);
  const World world(SampleCell(plan));
  MotionProgram rounded = program;
  rounded.blend_is_distance = true;
  for (Motion& motion : rounded.motions)
    if (!motion.exact) motion.blend = 1;
  // The straight passes have no corners; the ring's turn by 30°: 1/2·sin(15°) = 0.129 mm.
  const std::vector<Finding> findings = Verify(rounded, world, &program, SampleOptions(plan), {.threads = 2});
  EXPECT_NE(Text(findings).find("rounded by 0.129 mm"), std::string::npos) << Text(findings);
  EXPECT_EQ(Text(findings).find("rounded by 0.13"), std::string::npos) << Text(findings);
  for (Motion& motion : rounded.motions) motion.blend = motion.exact ? 0 : 0.1;
  EXPECT_EQ(Text(Verify(rounded, world, &program, SampleOptions(plan), {.threads = 2})), "");
}

TEST(Verify, OverlappingMotionsRoundTheOrientation) {
  // Straight and even for the tip, while the tool turns to and fro about its axis.
  PlanResult plan = SamplePlan({.points = 6, .spacing = 0.5, .ring = false, .passes = 1});
  const Pose turn =
      plan.X_FT * Eigen::AngleAxisd(1 * kRadPerDeg, Eigen::Vector3d::UnitZ()) * plan.X_FT.inverse();
  for (size_t i = 1; i < 5; i += 2) {
    Joints& q = plan.passes[0].points[i].q;
    q = InverseNear(plan.arm, ForwardFlange(plan.arm, q) * turn, Status(plan.arm, q), q).value();
  }
  for (PlannedPoint& point : plan.passes[0].points) point.point.feed_rate = 5;
  const MotionProgram program = MakeMotionProgram(plan);
  const auto rounded = [&](const std::string& variant, double acceleration) {
    const auto post = SamplePost(variant);
    const PostSettings settings = SampleSettings(variant);
    const MotionProgram read = post->Read(post->Write(program, plan.arm, settings), plan.arm, settings);
    Cell cell = SampleCell(plan);
    cell.arm.acceleration.setConstant(acceleration);
    const std::string text = Text(Verify(read, World(cell), &program, SampleOptions(plan), {.threads = 2}));
    return text.find("the corner is rounded by") != std::string::npos;
  };
  EXPECT_FALSE(rounded("linuxcnc_cartesian", 1e5));
  EXPECT_TRUE(rounded("linuxcnc_cartesian", 3));
  // The tool's turn moves the joints 1 to 3 too: G64 P bounds these, and with them how long motions overlap.
  EXPECT_FALSE(rounded("linuxcnc", 3));
}

TEST(Verify, SeesAPointLeftOutOnAWayThereAndBack) {
  // Out to the last point and back on the same line: without the turning point no place is off the plan's
  // path.
  PlanResult plan = SamplePlan({.points = 6, .ring = false, .passes = 1});
  std::vector<PlannedPoint>& points = plan.passes[0].points;
  points = {points[0], points[1], points[4], points[5], points[3], points[2]};
  const MotionProgram program = MakeMotionProgram(plan);
  const World world(SampleCell(plan));
  EXPECT_EQ(Text(Verify(program, world, &program, SampleOptions(plan), {.threads = 2})), "");
  MotionProgram shorter = program;
  std::erase_if(shorter.motions, [](const Motion& motion) { return motion.point == 3; });
  for (ProgramEvent& event : shorter.events)
    if (event.before_motion == program.motions.size() || event.before_motion > 4) event.before_motion -= 1;
  ASSERT_EQ(shorter.motions.size() + 1, program.motions.size());
  const std::string text = Text(Verify(shorter, world, &program, SampleOptions(plan), {.threads = 2}));
  EXPECT_NE(text.find("is not reached"), std::string::npos) << text;
}

TEST(Verify, SeesAWristThatIsSingularAndJointsThatAreTooFast) {
  const PlanResult plan = SamplePlan();
  const MotionProgram program = MakeMotionProgram(plan);
  VerifyOptions options = SampleOptions(plan);
  EXPECT_EQ(Text(Verify(program, World(SampleCell(plan)), &program, options, {.threads = 2})), "");
  options.wrist_least = 2;  // no angle has so large a sine
  EXPECT_NE(Text(Verify(program, World(SampleCell(plan)), &program, options, {.threads = 2}))
                .find("wrist is singular"),
            std::string::npos);
  Cell slow = SampleCell(plan);
  slow.arm.speed *= 1e-4;
  EXPECT_NE(
      Text(Verify(program, World(slow), &program, SampleOptions(plan), {.threads = 2})).find("would turn at"),
      std::string::npos);
}

TEST(Verify, OverlapIsAParabola) {
  const Joints before = Joints::Constant(0.1), acceleration = Joints::Constant(2);
  Joints after = before;
  after[4] = -0.3;
  // 0.3 rad/s at 2 rad/s²: 0.15 s, an eighth of which times a change by 0.4 rad/s.
  EXPECT_NEAR(OverlapRounding(before, after, acceleration, 1)[4], -0.0075, 1e-12);
  EXPECT_EQ(OverlapRounding(before, after, acceleration, 1)[0], 0);
  EXPECT_NEAR(OverlapRounding(before, after, acceleration, 0.05)[4], -0.0025, 1e-12);
}

TEST(Verify, SlowTurningSlowsTheFeed) {
  const PlanResult plan = SamplePlan();
  const MotionProgram program = MakeMotionProgram(plan);
  const World world(SampleCell(plan));
  MotionProgram slow = program;
  for (Motion& motion : slow.motions) motion.turn_speed = 200 * kRadPerDeg;
  EXPECT_EQ(Text(Verify(slow, world, &program, SampleOptions(plan), {.threads = 2})), "");
  for (Motion& motion : slow.motions) motion.turn_speed = 0.01 * kRadPerDeg;
  EXPECT_NE(Text(Verify(slow, world, &program, SampleOptions(plan), {.threads = 2})).find("runs at"),
            std::string::npos);
}

TEST(Verify, SeesOutputsElsewhere) {
  const PlanResult plan = SamplePlan();
  MotionOptions options;
  options.outputs = {{3, true, 0, true}, {3, false, 0, false}};
  const MotionProgram program = MakeMotionProgram(plan, options);
  const World world(SampleCell(plan));
  const auto verified = [&](const std::function<void(std::vector<ProgramEvent>&)>& edit) {
    MotionProgram other = program;
    edit(other.events);
    return Text(Verify(other, world, &program, SampleOptions(plan), {.threads = 2}));
  };
  const auto output = [](std::vector<ProgramEvent>& events) {
    return std::find_if(events.begin(), events.end(),
                        [](const ProgramEvent& e) { return e.kind == ProgramEvent::Kind::kOutput; });
  };
  EXPECT_EQ(verified([](auto&) {}), "");
  EXPECT_NE(verified([&](auto& events) { output(events)->output.number = 4; }), "");
  EXPECT_NE(verified([&](auto& events) { output(events)->output.on = false; }), "");
  EXPECT_NE(verified([&](auto& events) { output(events)->output.delay = 0.01; }), "");
  EXPECT_NE(verified([&](auto& events) { events.erase(output(events)); }), "");
  EXPECT_NE(verified([&](auto& events) { output(events)->before_motion += 1; }), "");
}

TEST(Verify, SeesDwellsElsewhere) {
  const PlanResult plan = SamplePlan();
  MotionProgram program = MakeMotionProgram(plan);
  const World world(SampleCell(plan));
  const auto middle = std::ranges::find(program.motions, 2, &Motion::point);
  ASSERT_NE(middle, program.motions.end());
  middle->exact = true;
  const size_t behind = static_cast<size_t>(middle - program.motions.begin()) + 1;
  const auto with = [&](size_t before_motion, double seconds) {
    MotionProgram other = program;
    const auto after = std::ranges::find_if(
        other.events, [&](const ProgramEvent& event) { return event.before_motion >= before_motion; });
    other.events.insert(after, {ProgramEvent::Kind::kDwell, before_motion, seconds, 0, {}, 0, 0});
    return other;
  };
  const MotionProgram planned = with(behind, 0.5);
  const auto told = [&](const MotionProgram& given) {
    return Text(Verify(given, world, &planned, SampleOptions(plan), {.threads = 2}));
  };
  EXPECT_EQ(told(planned), "");
  EXPECT_NE(told(program).find("a dwell of 0.5 s is missing here"), std::string::npos);
  EXPECT_NE(told(with(behind, 0.4)).find("a dwell of 0.4 s is here, planned is a dwell of 0.5 s"),
            std::string::npos);
  const auto plunge = std::ranges::find(program.motions, 0, &Motion::point);
  const size_t elsewhere = static_cast<size_t>(plunge - program.motions.begin()) + 1;
  EXPECT_NE(told(with(elsewhere, 0.5)).find("a dwell of 0.5 s happens elsewhere"), std::string::npos);
  // Between cuts the motions alone say nothing of waits: that takes the program as it was written.
  MotionProgram waits = planned;
  waits.events.insert(waits.events.begin(), {ProgramEvent::Kind::kDwell, 0, 3, 0, {}, 0, 0});
  EXPECT_EQ(told(waits), "");
  VerifyOptions options = SampleOptions(plan);
  options.written = &planned;
  EXPECT_NE(Text(Verify(waits, world, &planned, options, {.threads = 2}))
                .find("a dwell of 3 s is not planned here"),
            std::string::npos);
}

TEST(ArmBodies, BoundHowFarTheArmIs) {
  const PlanResult plan = SamplePlan();
  const Cell cell = SampleCell(plan);
  const ArmBodies bodies(cell);
  const Joints q = plan.passes[0].points[0].q;
  for (int joint = 0; joint < 6; ++joint) {
    Joints p = q;
    p[joint] += 0.002;
    // No point of a body is left out: corners of the tool's cylinders are within the bound found by halving.
    double lower = 0, upper = 100;
    while (upper - lower > 1e-3) {
      const double middle = (lower + upper) / 2;
      (bodies.MovesFurther(q, p, middle) ? lower : upper) = middle;
    }
    const Pose a = ForwardFlange(cell.arm, q) * cell.X_FT, b = ForwardFlange(cell.arm, p) * cell.X_FT;
    for (const Eigen::Vector3d& corner : {Eigen::Vector3d(80, 0, 320), Eigen::Vector3d(-80, 0, 120),
                                          Eigen::Vector3d(0, 80, 320), Eigen::Vector3d(0, 0, 0)}) {
      EXPECT_LE((a * corner - b * corner).norm(), upper + 1e-3) << joint;
    }
  }
  EXPECT_FALSE(bodies.MovesFurther(q, q, 1e-9));
}

/// A body beside the spindle, `distance` mm from it at joint angles q.
Cell WithBlock(const PlanResult& plan, const Joints& q, double distance) {
  Cell cell = SampleCell(plan);
  Body block;
  block.name = "block";
  block.body_class = BodyClass::kFixture;
  block.X_MG.translation() =
      plan.X_WB * ForwardFlange(plan.arm, q) * plan.X_FT * Eigen::Vector3d(80 + 20 + distance, 0, 250);
  block.shape = Sphere{20};
  cell.bodies.push_back(block);
  return cell;
}

TEST(Verify, ChecksAgainWhatLeavesTheProvenMotion) {
  // A cut of 2.5 mm, 8 mm from a body: 10 mm are asked.
  const PlanResult plan = SamplePlan({.points = 6, .spacing = 0.5, .ring = false, .passes = 1});
  const MotionProgram program = MakeMotionProgram(plan);
  const World world(WithBlock(plan, plan.passes[0].points[3].q, 8));
  VerifyOptions options = SampleOptions(plan);
  const auto sees_block = [&] {
    return Text(Verify(program, world, &program, options, {.threads = 2})).find("block") != std::string::npos;
  };
  // As far as verification knows the planner has proven that: it looks only at what leaves the proof.
  EXPECT_FALSE(sees_block());
  options.clearance_reserve = 1e-9;  // the straight motion leaves the joint motion by more than that
  EXPECT_TRUE(sees_block());
  options.interference = true;
  options.clearance_reserve = 0.5;
  EXPECT_TRUE(sees_block());
}

TEST(Verify, AReducedGapKeepsItsShareOfTheClearance) {
  PlanResult plan = SamplePlan();
  const std::vector<Joints>& way = plan.gaps[0].joints;
  // A body from which the first gap keeps between 5.5 and 8.5 mm.
  std::optional<World> world;
  for (double distance = 0; distance < 300 && !world; distance += 1) {
    const World candidate(WithBlock(plan, way[1], distance));
    Checker checker(candidate);
    double least = 100;
    for (int i = 0; i <= 400; ++i) {
      const size_t leg = i < 200 ? 0 : 1;
      const Joints q = way[leg] + (way[leg + 1] - way[leg]) * ((i - 200.0 * leg) / 200);
      least = std::min(least, checker.Clearance(q, Phase::kFree, least));
    }
    if (least > 5.5 && least < 8.5) world = candidate;
  }
  ASSERT_TRUE(world);
  VerifyOptions options = SampleOptions(plan);
  options.interference = true;
  const auto sees_block = [&] {
    const MotionProgram program = MakeMotionProgram(plan);
    return Text(Verify(program, *world, &program, options, {.threads = 2})).find("block") !=
           std::string::npos;
  };
  EXPECT_TRUE(sees_block());
  // The last gap runs by the same way-point.
  plan.gaps.front().clearance_share = plan.gaps.back().clearance_share = 0.9;
  EXPECT_TRUE(sees_block());
  plan.gaps.front().clearance_share = plan.gaps.back().clearance_share = 0.5;
  EXPECT_FALSE(sees_block());
}

TEST(Verify, SeesJumpsOfTheSpeedWithoutAPlan) {
  const PlanResult plan = SamplePlan();
  const World world(SampleCell(plan));
  MotionProgram program = MakeMotionProgram(plan);
  EXPECT_EQ(Text(Verify(program, world, nullptr, SampleOptions(plan), {.threads = 2})), "");
  const auto cut = std::find_if(program.motions.begin(), program.motions.end(),
                                [](const Motion& motion) { return motion.point >= 3 && !motion.exact; });
  cut->feed *= 20;
  const std::string text = Text(Verify(program, world, nullptr, SampleOptions(plan), {.threads = 2}));
  EXPECT_NE(text.find("the feed jumps from"), std::string::npos) << text;
}

}  // namespace
}  // namespace millpose
