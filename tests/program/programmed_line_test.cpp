// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/programmed_line.hpp"

#include <gtest/gtest.h>

#include <random>

#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/bound_turns.hpp"
#include "program/economy.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Pose Turned(const Vector3d& axis, double degrees, double along = 0) {
  Pose pose = Pose::Identity();
  pose.translation().x() = along;
  pose.linear() = AngleAxisd(degrees * kRadPerDeg, axis.normalized()).toRotationMatrix();
  return pose;
}

double Apart(const Matrix3d& a, const Matrix3d& b) { return AngleAxisd(a.transpose() * b).angle(); }

/// LIN's orientation by quaternions: the swing that takes one direction to the other, and the twist left
/// over.
Matrix3d Swivelled(const Matrix3d& from, const Matrix3d& to, const Vector3d& direction, double share) {
  const Eigen::Quaterniond swing = Eigen::Quaterniond::FromTwoVectors(from * direction, to * direction);
  const AngleAxisd swung(swing);
  const Matrix3d twist = from.transpose() * swing.inverse() * to;
  AngleAxisd twisted(twist);
  const double angle = twisted.axis().dot(direction) < 0 ? -twisted.angle() : twisted.angle();
  return AngleAxisd(share * swung.angle(), swung.axis()) * from * AngleAxisd(share * angle, direction);
}

TEST(Swivel, IsAnEvenSwingAndAnEvenTwist) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int i = 0; i < 50; ++i) {
    const auto vector = [&] { return Vector3d(number(random), number(random), number(random)); };
    const Pose from = Turned(vector(), 90 * number(random)), to = Turned(vector(), 90 * number(random), 5);
    const Vector3d direction = Vector3d::Unit(i % 3);
    const ProgrammedLine line(from, to, direction);
    EXPECT_LT(Apart(line.At(0).linear(), from.linear()), 1e-12);
    EXPECT_LT(Apart(line.At(1).linear(), to.linear()), 1e-12);
    for (const double share : {0.2, 0.5, 0.7}) {
      EXPECT_LT(Apart(line.At(share).linear(), Swivelled(from.linear(), to.linear(), direction, share)),
                1e-9);
      // The direction stays in the plane of its two ends.
      const Vector3d normal = (from.linear() * direction).cross(to.linear() * direction);
      EXPECT_LT(std::abs((line.At(share).linear() * direction).dot(normal)), 1e-12);
    }
    EXPECT_GE(line.angle() + 1e-12, Apart(from.linear(), to.linear()));
  }
}

TEST(Swivel, IsTheEvenTurnAlongAndAcrossItsDirection) {
  const Pose from = Turned({0, 0, 1}, 0);
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 3, 4)}) {
    const Pose to = Turned(axis, 70);
    EXPECT_LT(TurnDeviation(ProgrammedLine(from, to, Vector3d::UnitX()), from, to), 1e-12)
        << axis.transpose();
  }
  // Half of each: 12 degrees in one motion leave the even turn by more than a tolerance of 0.02 degrees.
  const Pose to = Turned({1, 1, 0}, 12);
  EXPECT_GT(TurnDeviation(ProgrammedLine(from, to, Vector3d::UnitX()), from, to), 0.02 * kRadPerDeg);
}

TEST(Swivel, AHalfTurnOfTheDirectionAndNoTurnAtAll) {
  const Pose from = Turned({0, 0, 1}, 0), back = Turned({0, 0, 1}, 180);
  EXPECT_LT(Apart(ProgrammedLine(from, back, Vector3d::UnitX()).At(1).linear(), back.linear()), 1e-12);
  EXPECT_EQ(ProgrammedLine(from, from, Vector3d::UnitX()).angle(), 0);
}

/// A program whose tool turns about an axis across and along X at once, by `degrees` from point to point.
MotionProgram Turning(PlanResult& plan, double degrees) {
  plan = SamplePlan({.points = 4, .spacing = 30, .ring = false, .passes = 1});
  for (size_t i = 0; i < plan.passes[0].points.size(); ++i) {
    Joints& q = plan.passes[0].points[i].q;
    const Pose turn =
        plan.X_FT *
        AngleAxisd(static_cast<double>(i) * degrees * kRadPerDeg, Vector3d(1, 0, 1).normalized()) *
        plan.X_FT.inverse();
    q = InverseNear(plan.arm, ForwardFlange(plan.arm, q) * turn, Status(plan.arm, q), q).value();
  }
  return MakeMotionProgram(plan);
}

TEST(BoundTurns, InsertsWhatTheToleranceAsksFor) {
  PlanResult plan;
  const MotionProgram planned = Turning(plan, 8);
  const TurnBound bound{
      {[](const Pose& a, const Pose& b) { return ProgrammedLine(a, b, Vector3d::UnitZ()); }},
      0.016 * kRadPerDeg};
  MotionProgram written = planned;
  std::vector<size_t> origin;
  for (size_t i = 0; i < planned.motions.size(); ++i) origin.push_back(i);
  const int inserted = BoundTurns(written, origin, plan.arm, bound);
  ASSERT_GT(inserted, 0);
  ASSERT_EQ(written.motions.size(), planned.motions.size() + static_cast<size_t>(inserted));
  ASSERT_EQ(origin.size(), written.motions.size());
  ASSERT_TRUE(IsWellFormed(written));
  for (size_t i = 1; i < written.motions.size(); ++i) {
    const Motion& motion = written.motions[i];
    const Pose reached = written.X_BP->inverse() * ForwardFlange(plan.arm, *motion.q) * *written.X_FT;
    EXPECT_LT((reached.translation() - motion.X_PT.translation()).norm(), 1e-6);
    EXPECT_LT(Apart(reached.linear(), motion.X_PT.linear()), 1e-9);
    if (motion.type != MotionType::kLinear) continue;
    // Ten times as densely as the tool looks itself: LIN never leaves the planned turn by more.
    const PoseLine even(planned.motions[origin[i] - 1].X_PT, planned.motions[origin[i]].X_PT);
    const Pose& from = written.motions[i - 1].X_PT;
    const double begin = (from.translation() - even.from()).norm() / even.length();
    const double end = (motion.X_PT.translation() - even.from()).norm() / even.length();
    const ProgrammedLine line(from, motion.X_PT, Vector3d::UnitZ());
    for (int k = 0; k <= 40; ++k) {
      const double share = k / 40.0;
      EXPECT_LE(Apart(line.At(share).linear(), even.At(begin + share * (end - begin)).linear()),
                0.02 * kRadPerDeg);
    }
  }
  // What happened before a motion happens before the first of its parts.
  ASSERT_EQ(written.events.size(), planned.events.size());
  for (size_t i = 0; i < written.events.size(); ++i) {
    const size_t before = written.events[i].before_motion, was = planned.events[i].before_motion;
    EXPECT_TRUE(before == written.motions.size() ? was == planned.motions.size() : origin[before] == was);
    if (before > 0) {
      EXPECT_EQ(origin[before - 1], was - 1);
    }
  }
}

TEST(BoundTurns, LeavesSmallTurnsAlone) {
  PlanResult plan;
  MotionProgram written = Turning(plan, 0.3);
  std::vector<size_t> origin;
  for (size_t i = 0; i < written.motions.size(); ++i) origin.push_back(i);
  const TurnBound bound{
      {[](const Pose& a, const Pose& b) { return ProgrammedLine(a, b, Vector3d::UnitZ()); }},
      0.016 * kRadPerDeg};
  EXPECT_EQ(BoundTurns(written, origin, plan.arm, bound), 0);
}

/// Three points; from each to the next the tool turns by 12.3° about its axis, which leans over by 0.4° as
/// well. The middle one lies where LIN has swivelled the tool, or where one even turn has it.
MotionProgram TwelveDegrees(PlanResult& plan, bool even) {
  plan = SamplePlan({.points = 3, .spacing = 10, .ring = false, .passes = 1});
  const Joints start = plan.passes[0].points[0].q;
  const auto turned = [](double steps) {
    return AngleAxisd(0.4 * steps * kRadPerDeg, Vector3d::UnitX()) *
           AngleAxisd(12.3 * steps * kRadPerDeg, Vector3d::UnitZ());
  };
  AngleAxisd half(turned(2));
  half.angle() /= 2;
  const Pose first = ForwardFlange(plan.arm, start) * plan.X_FT;
  for (size_t i = 0; i < plan.passes[0].points.size(); ++i) {
    Joints& q = plan.passes[0].points[i].q;
    Pose tool = ForwardFlange(plan.arm, q) * plan.X_FT;
    tool.linear() =
        first.linear() * (even && i == 1 ? Matrix3d(half) : Matrix3d(turned(static_cast<double>(i))));
    q = InverseNear(plan.arm, tool * plan.X_FT.inverse(), Status(plan.arm, q), q).value();
  }
  return MakeMotionProgram(plan);
}

TEST(Swivel, TwelveDegreesAboutAnAxisThatLeansAreLeftOutAsTheControlTurnsThem) {
  const LineModel swivels = [](const Pose& a, const Pose& b) {
    return ProgrammedLine(a, b, Vector3d::UnitZ());
  };
  for (const bool even : {false, true}) {
    PlanResult plan;
    const MotionProgram planned = TwelveDegrees(plan, even);
    const auto saved = [&](const std::vector<LineModel>& lines) {
      return Economise(planned,
                       {.position_tolerance = 0.01, .angle_tolerance = 0.016 * kRadPerDeg, .lines = lines})
          .saved;
    };
    EXPECT_EQ(saved({swivels}), even ? 0 : 1);
    EXPECT_EQ(saved({}), even ? 1 : 0);
  }
}

}  // namespace
}  // namespace millpose
