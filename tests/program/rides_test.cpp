// SPDX-License-Identifier: GPL-3.0-or-later
// Programs whose external axes move along cuts: what they say, by plain arithmetic; written, read and written
// again.
#include <gtest/gtest.h>

#include <functional>

#include "base/error.hpp"
#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/result/station.hpp"
#include "program/bound_turns.hpp"
#include "program/economy.hpp"
#include "program/external_axes.hpp"
#include "program/krl/krl.hpp"
#include "program/make_timeline.hpp"
#include "program/scanner.hpp"
#include "tests/program/interpreter.hpp"
#include "tests/program/program_lines.hpp"
#include "tests/program/station_plan.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// Where the tip is on the part, by the plan's own frames.
Vector3d TipOnPart(const PlanResult& plan, const Joints& q, const ExternalPosition& external) {
  return (PartAt(plan, external).inverse() * BaseAt(plan, external) * ForwardFlange(plan.arm, q) * plan.X_FT)
      .translation();
}

struct RideCase {
  std::string variant, axes;
};

class RidePosts : public testing::TestWithParam<RideCase> {
 protected:
  PlanResult plan = RidePlan(GetParam().axes);
  MotionProgram program = MakeMotionProgram(plan, SampleFeeds());
  StationPost post{GetParam().variant, plan, true};  // LinuxCNC's joints count from nothing all the same
  ProgramFiles files = post.Write(program, plan.arm);

  std::string Text() const { return files.rbegin()->second; }
  MotionProgram Read() const { return post.post->Read(files, plan.arm, post.settings); }
};

std::vector<RideCase> RideCases() {
  std::vector<RideCase> cases;
  for (const char* variant : {"krl", "sinumerik", "sinumerik_euler", "linuxcnc", "linuxcnc_cartesian"})
    for (const char* axes : {"rail", "table", "both"}) cases.push_back({variant, axes});
  return cases;
}
INSTANTIATE_TEST_SUITE_P(All, RidePosts, testing::ValuesIn(RideCases()),
                         [](const auto& c) { return c.param.variant + "_" + c.param.axes; });

TEST(RideMotions, EachPointHasItsOwnPositionAndTheTipItsPath) {
  for (const char* axes : {"rail", "table", "both"}) {
    const PlanResult plan = RidePlan(axes);
    const MotionProgram program = MakeMotionProgram(plan, SampleFeeds()),
                        standing = MakeMotionProgram(StationPlan(axes), SampleFeeds());
    EXPECT_TRUE(HasCoordinatedMotions(program));
    EXPECT_FALSE(HasCoordinatedMotions(standing));
    ASSERT_EQ(program.motions.size(), standing.motions.size());
    int rides = 0;
    for (size_t i = 0; i < program.motions.size(); ++i) {
      const Motion& motion = program.motions[i];
      if (motion.point >= 0) {
        const PassResult& pass = plan.passes[static_cast<size_t>(motion.pass)];
        EXPECT_EQ(motion.external, ExternalAt(pass, static_cast<size_t>(motion.point)));
      }
      if (motion.type == MotionType::kLinear) {
        EXPECT_LT((motion.X_PT.matrix() - standing.motions[i].X_PT.matrix()).cwiseAbs().maxCoeff(), 1e-7)
            << i;
      }
      EXPECT_EQ(motion.X_BP_begin.has_value(), CoordinatedMotions(program, i)) << i;
      rides += CoordinatedMotions(program, i);
      if (!CoordinatedMotions(program, i)) continue;
      EXPECT_EQ(motion.X_BP_begin->matrix(), program.motions[i - 1].X_BP->matrix());
      EXPECT_TRUE(IsCut(program, i));  // approach and retract stand
    }
    EXPECT_EQ(rides, 6);
  }
}

// The law of such a motion: straight on the part, all external axes with the same share of their way.
TEST(RideMotions, TheTipGoesStraightOnThePart) {
  const PlanResult plan = RidePlan("both");
  const MotionProgram program = MakeMotionProgram(plan, SampleFeeds());
  for (size_t i = 1; i < program.motions.size(); ++i) {
    if (!CoordinatedMotions(program, i)) continue;
    const Motion &from = program.motions[i - 1], &to = program.motions[i];
    for (const double share : {0.0, 0.2, 0.5, 0.9, 1.0}) {
      ExternalPosition there;
      for (size_t k = 0; k < 2; ++k)
        there.push_back(from.external[k] + share * (to.external[k] - from.external[k]));
      const Pose frame = BaseAt(plan, there).inverse() * PartAt(plan, there);
      EXPECT_LT((FrameAt(program, i, share).matrix() - frame.matrix()).cwiseAbs().maxCoeff(), 1e-7) << share;
      const Vector3d even =
          from.X_PT.translation() + share * (to.X_PT.translation() - from.X_PT.translation());
      EXPECT_LT((TipOnPart(plan, JointsOf(program, plan.arm, i, share), there) - even).norm(), 1e-6) << share;
    }
  }
}

TEST(RideMotions, TakeNoLessThanTheExternalAxesNeed) {
  PlanResult plan = RidePlan("rail");
  for (const double speed : {1000.0, 3.0}) {
    plan.external_axes[0].speed = speed;
    const MotionProgram program = MakeMotionProgram(plan, SampleFeeds());
    const std::vector<TimeLaw> laws = TimeMotions(program, plan.arm, {});
    for (size_t i = 1; i < laws.size(); ++i) {
      if (!CoordinatedMotions(program, i)) continue;
      const double way = std::abs(program.motions[i].external[0] - program.motions[i - 1].external[0]);
      EXPECT_GE(laws[i].duration, way / speed * (1 - 1e-12)) << i;
      if (speed < 10) {
        EXPECT_LT(laws[i].duration, way / speed + 1) << i;
      }
    }
  }
}

TEST(RideMotions, ATimelineFollowsThem) {
  const PlanResult plan = RidePlan("both");
  std::vector<RunInstant> cut;
  for (const RunInstant& instant : MakeTimeline(plan, {}, {})) {
    if (instant.point < 0) continue;
    const PassResult& pass = plan.passes[static_cast<size_t>(instant.pass)];
    const auto point = static_cast<size_t>(instant.point);
    EXPECT_EQ(instant.external, ExternalAt(pass, point));
    EXPECT_LT((instant.tip - pass.points[point].point.position).norm(), 1e-6);
    EXPECT_NE(instant.stretch, RunPart::kExternal);
    cut.push_back(instant);
  }
  EXPECT_EQ(cut.size(), 8u);
  const MotionProgram program = MakeMotionProgram(plan);
  const StationPost post("krl", plan, true);
  const std::string csv =
      TrajectoryCsv(program, plan.arm, plan.X_WB, ExternalColumns(post.settings), {}, 0.05);
  EXPECT_GT(csv.size(), 1000u);
}

TEST(RideMotions, PointsBetweenAreLeftOutWhereTheAxesGoEvenlyAlone) {
  const SampleShape fine{.points = 9, .spacing = 2, .ring = false};
  const auto kept = [&](double bend) {
    PlanResult plan = RidePlan("rail", fine);
    PlannedPoint& point = plan.passes[0].points[4];
    ExternalPosition there = *point.external;
    there[0] += bend;
    const Pose X_BF =
        BaseAt(plan, there).inverse() * BaseAt(plan, *point.external) * ForwardFlange(plan.arm, point.q);
    point.q = *InverseNear(plan.arm, X_BF, Status(plan.arm, point.q), point.q);
    point.external = there;
    const MotionProgram program = MakeMotionProgram(plan, SampleFeeds());
    const EconomyResult result = Economise(program, {.position_tolerance = 0.01, .angle_tolerance = 0.05});
    int points = 0;
    for (size_t i = 0; i < result.program.motions.size(); ++i) {
      const Motion& motion = result.program.motions[i];
      points += motion.pass == 0 && motion.point >= 0;
      EXPECT_EQ(motion.X_BP_begin.has_value(), CoordinatedMotions(result.program, i));
      if (motion.X_BP_begin) {
        EXPECT_EQ(motion.X_BP_begin->matrix(), result.program.motions[i - 1].X_BP->matrix());
      }
    }
    return points;
  };
  EXPECT_EQ(kept(0), 2);
  EXPECT_EQ(kept(0.005), 2);  // within tolerance
  EXPECT_GE(kept(1), 4);
}

TEST(RideMotions, DividedOnesGoOnEvenly) {
  const PlanResult plan = RidePlan("both", {.points = 3, .spacing = 40, .ring = false, .tilt_deg = 20});
  MotionProgram program = MakeMotionProgram(plan, SampleFeeds());
  const MotionProgram whole = program;
  std::vector<size_t> origin(program.motions.size());
  for (size_t i = 0; i < origin.size(); ++i) origin[i] = i;
  // A way to turn the tool that is far off the even one wherever it turns at all.
  const auto late = [](const Pose& from, const Pose& to) {
    return ProgrammedLine(from, to, Vector3d(from.linear().transpose() * Vector3d::UnitX()));
  };
  TurnBound bound{{late}, 1e-9};
  PlanResult turned = plan;
  BoundTurns(program, origin, plan.arm, bound);
  for (size_t i = 1; i < program.motions.size(); ++i) {
    EXPECT_EQ(program.motions[i].X_BP_begin.has_value(), CoordinatedMotions(program, i));
    if (program.motions[i].X_BP_begin) {
      EXPECT_EQ(program.motions[i].X_BP_begin->matrix(), program.motions[i - 1].X_BP->matrix());
    }
    if (program.motions[i].type != MotionType::kLinear) continue;
    const Vector3d tip = TipOnPart(plan, *program.motions[i].q, program.motions[i].external);
    EXPECT_LT((tip - program.motions[i].X_PT.translation()).norm(), 1e-6);
  }
}

TEST_P(RidePosts, WritesTheSameAgainAfterReading) {
  const MotionProgram read = Read();
  EXPECT_EQ(post.Write(read, plan.arm), files);
  if (ControllerOf(GetParam().variant) == "linuxcnc") return;  // has more motions
  ASSERT_EQ(read.motions.size(), Prepared(program, *post.post, post.settings, plan.arm).motions.size());
  int rides = 0;
  for (size_t i = 0; i < read.motions.size(); ++i) rides += CoordinatedMotions(read, i);
  EXPECT_GE(rides, 6);
}

TEST_P(RidePosts, ReadsTheSameTipPathAndPositions) {
  const MotionProgram read = Read();
  size_t k = 0;  // of the planned cut points, in order
  std::vector<const Motion*> wanted;
  for (const Motion& motion : program.motions)
    if (motion.point >= 0) wanted.push_back(&motion);
  for (size_t i = 1; i < read.motions.size() && k < wanted.size(); ++i) {
    const Motion& motion = read.motions[i];
    if (!HasFeed(motion)) continue;
    const Vector3d tip = motion.q
                             ? TipOnPart(plan, *motion.q, motion.external)
                             : Vector3d((PartAt(plan, motion.external).inverse() *
                                         BaseAt(plan, motion.external) * *FrameOf(read, motion) * motion.X_PT)
                                            .translation());
    if ((tip - wanted[k]->X_PT.translation()).norm() > 0.002) continue;
    for (size_t axis = 0; axis < motion.external.size(); ++axis)
      EXPECT_NEAR(motion.external[axis], wanted[k]->external[axis], 1e-4) << motion.line;
    ++k;
  }
  EXPECT_EQ(k, wanted.size());
}

TEST_P(RidePosts, OneFrameHoldsAlongACut) {
  const std::string& variant = GetParam().variant;
  if (ControllerOf(variant) == "linuxcnc") return;
  size_t count = 0;
  const std::string whole = Text();
  for (const std::string_view line : SplitLines(whole))
    count += line.starts_with(variant == "krl" ? "$BASE = " : "$P_UIFR[");
  EXPECT_EQ(count, 1u);
}

TEST_P(RidePosts, TheInterpreterAccepts) {
  if (ControllerOf(GetParam().variant) != "linuxcnc") return;
  ExpectInterpreted(Text(), Read());
}

// KRL, by hand: on a coupled rail X, Y, Z are where the tip is on the part, whatever E1 says; E1 grows
// evenly.
TEST(RideTexts, KrlStatesE1InEveryTarget) {
  const PlanResult plan = RidePlan("rail");
  const StationPost post("krl", plan, true);
  const std::string text = post.Write(MakeMotionProgram(plan, SampleFeeds()), plan.arm).rbegin()->second;
  std::vector<double> rail;
  for (const std::string_view line : SplitLines(text)) {
    if (!line.starts_with("LIN {")) continue;
    const size_t at = line.find(",E1 ");
    ASSERT_NE(at, std::string_view::npos) << line;
    rail.push_back(std::stod(std::string(line.substr(at + 4))));
  }
  // Approach in two parts, three motions, retract; twice.
  EXPECT_EQ(rail, (std::vector<double>{100, 100, 120, 140, 160, 160, 400, 400, 420, 440, 460, 460}));
}

TEST(RideTexts, SinumerikStatesTheAxisWhereItMovesAndWhatFMeans) {
  const PlanResult plan = RidePlan("rail");
  const auto text = [](const PlanResult& of) {
    return StationPost("sinumerik", of, true)
        .Write(MakeMotionProgram(of, SampleFeeds()), of.arm)
        .rbegin()
        ->second;
  };
  size_t count = 0;
  const std::string riding = text(plan);
  for (const std::string_view line : SplitLines(riding))
    count += line.find("G1 ") != std::string_view::npos && line.find("RAIL_AX=") != std::string_view::npos;
  EXPECT_GE(count, 6u);
  EXPECT_NE(riding.find("; ASSUMED F counts along X, Y, Z alone (FGROUP)"), std::string::npos);
  EXPECT_EQ(text(StationPlan("rail")).find("FGROUP"), std::string::npos);
}

// The controller has measured its rail otherwise than the cell, within a degree: $BASE cannot follow along a
// cut, the targets make up for it.
TEST(RideTexts, ARailMeasuredOtherwiseNeedsNoOtherBaseWithinACut) {
  const PlanResult plan = RidePlan("rail");
  const StationPost whole("krl", plan, true);
  KrlOptions options = dynamic_cast<const KrlPost&>(*whole.post).options();
  options.ersysroot->pose.abc = Vector3d(0.5 * kRadPerDeg, 0, 0);
  options.robroot->abc = Vector3d(-0.5 * kRadPerDeg, 0, 0);
  const KrlPost post(options);
  ASSERT_EQ(post.WhyNotIn(whole.settings), "");
  const MotionProgram program = MakeMotionProgram(plan, SampleFeeds());
  const ProgramFiles files = post.Write(program, plan.arm, whole.settings);
  const MotionProgram read = post.Read(files, plan.arm, whole.settings);
  EXPECT_EQ(post.Write(read, plan.arm, whole.settings), files);
  int compared = 0;
  for (size_t i = 0; i < read.motions.size(); ++i) {
    if (!CoordinatedMotions(read, i)) continue;
    for (const double share : {0.0, 0.5, 1.0}) {
      const ExternalPosition there = ExternalOf(read, i, share);
      const PoseLine line(read.motions[i].X_BP_begin ? read.motions[i - 1].X_PT : Pose::Identity(),
                          read.motions[i].X_PT);
      const Vector3d tip =
          (PartAt(plan, there).inverse() * BaseAt(plan, there) * FrameAt(read, i, share) * line.At(share))
              .translation();
      const Vector3d wanted =
          PoseLine(program.motions[i - 1].X_PT, program.motions[i].X_PT).At(share).translation();
      EXPECT_LT((tip - wanted).norm(), 0.001) << read.motions[i].line;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 18);
}

TEST(RideTexts, WhatTheControllerDoesNotCountInMustStandStill) {
  const PlanResult plan = RidePlan("rail");
  for (const char* variant : {"krl", "sinumerik", "linuxcnc_cartesian"}) {
    const StationPost coupled(variant, plan, true), alone(variant, plan, false);
    const ProgramFiles files = coupled.Write(MakeMotionProgram(plan, SampleFeeds()), plan.arm);
    try {
      alone.post->Read(files, plan.arm, alone.settings);
      ADD_FAILURE() << variant;
    } catch (const InputError& error) {
      EXPECT_GT(error.problems().front().place.line, 0);
      EXPECT_NE(std::string(error.what()).find("coupled: false in the cell"), std::string::npos)
          << error.what();
    }
  }
  const StationPost krl("krl", plan, false);
  EXPECT_NE(WhyNotAlongCuts(krl.settings, "krl", "rail", false).find("E1 is coupled: false"),
            std::string::npos);
  EXPECT_EQ(WhyNotAlongCuts(krl.settings, "krl", "rail", true), "");
  const StationPost coupled("krl", plan, true);
  EXPECT_EQ(WhyNotAlongCuts(coupled.settings, "krl", "rail", false), "");
}

}  // namespace
}  // namespace millpose
