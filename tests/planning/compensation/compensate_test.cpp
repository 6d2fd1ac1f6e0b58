// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/compensation/compensate.hpp"

#include <gtest/gtest.h>

#include "machine/robot/kinematics.hpp"
#include "planning/compensation/gain.hpp"
#include "planning/result/station.hpp"
#include "tests/planning/compensation/forced_plan.hpp"

namespace millpose {
namespace {

/// The forced plan with a soft rail along W's y: at each point of a pass where `at` says, the part at rest.
PlanResult OnRail(const std::vector<double>& at) {
  PlanResult plan = Forced();
  plan.external_axes = {{.name = "rail", .direction = Eigen::Vector3d::UnitY(), .compliance = 1e-5}};
  plan.passes.resize(1);
  PassResult& pass = plan.passes[0];
  pass.external = {at.front()};
  for (size_t i = 0; i < pass.points.size(); ++i) {
    // The joints stay: base and part move by the same, as if the tip rode along.
    const double rail = at.size() > 1 ? at[i] : at.front();
    pass.points[i].point.position.y() += rail;
    if (at.size() > 1) pass.points[i].external = ExternalPosition{rail};
  }
  return plan;
}

TEST(Compensate, IsThatOfEachPointsOwnPosition) {
  std::vector<double> along;
  for (size_t i = 0; i < Forced().passes[0].points.size(); ++i)
    along.push_back(100 + 3 * static_cast<double>(i));
  PlanResult moving = OnRail(along);
  const CompensationOptions options = Sure();
  Compensate(options, ForcesOf(moving), moving);
  size_t taken = 0;
  for (size_t i = 0; i < along.size(); ++i) {
    PlanResult still = OnRail({along[i]});
    Compensate(options, ForcesOf(still), still);
    const Compensation &own = *moving.passes[0].points[i].compensation,
                       &there = *still.passes[0].points[i].compensation;
    EXPECT_EQ(own.normal.expected, there.normal.expected);
    EXPECT_EQ(own.normal.low, there.normal.low);
    if (own.shift.isZero(0)) continue;
    ++taken;
    // The commanded pose is the shifted one in the base where it is then.
    const Pose X_WB = BaseAt(moving, ExternalAt(moving.passes[0], i));
    const auto tip = [&](const Joints& q) -> Eigen::Vector3d {
      return (X_WB * ForwardFlange(moving.arm, q) * moving.X_FT).translation();
    };
    EXPECT_LT((tip(own.q) - tip(moving.passes[0].points[i].q) - own.shift).norm(), 1e-6);
  }
  EXPECT_GT(taken, 5u);
}

using Eigen::Vector3d;

Vector3d TipAt(const PlanResult& plan, const Joints& q) {
  return (plan.X_WB * ForwardFlange(plan.arm, q) * plan.X_FT).translation();
}

/// Where the tip stands under a point's force, above its nominal place along `direction`.
double Loaded(const PlanResult& plan, const PlannedPoint& point, const Vector3d& force,
              const Vector3d& direction) {
  const Joints& q = point.compensation->q;
  const Matrix6 C = Compliance(Jacobian(plan.arm, q, plan.X_FT.translation()), plan.arm.stiffness);
  const Eigen::Matrix3d R = plan.X_WB.linear();
  const Vector3d moved = R * (C.topLeftCorner<3, 3>() * (R.transpose() * force));
  return direction.dot(TipAt(plan, q) + moved - point.point.position);
}

TEST(Compensate, TakesOutWhatIsSureToAHundredthOfAMicrometre) {
  PlanResult plan = Forced();
  const CompensationCounts counts = Compensate(Sure(), ForcesOf(plan), plan);
  size_t shifted = 0;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      ASSERT_TRUE(point.compensation);
      const Compensation& c = *point.compensation;
      EXPECT_LT((TipAt(plan, c.q) - point.point.position - c.shift).norm(), 1e-9);
      const bool start = pass.pieces.front().closed && &point == &pass.points.front();
      if (start) {
        EXPECT_EQ(c.shift, Vector3d::Zero());  // is passed again where the ring closes
        continue;
      }
      ++shifted;
      EXPECT_GT(std::abs(c.normal.expected), 0.005);
      EXPECT_LT(std::abs(Loaded(plan, point, point.point.engagement.force, point.point.normal)), 1e-5);
    }
  EXPECT_EQ(counts.shifted, shifted);
  EXPECT_EQ(counts.cut, 0u);
  ASSERT_TRUE(MedianRemains(Sure(), plan));
  EXPECT_LT(*MedianRemains(Sure(), plan), 1e-9);
}

TEST(Compensate, FullTakesOutWhatLiesAcrossTheFeedToo) {
  PlanResult plan = Forced();
  for (PassResult& pass : plan.passes)
    for (PlannedPoint& point : pass.points)
      point.point.engagement.force = 100 * point.point.normal.cross(point.point.feed);
  CompensationOptions options = Sure();
  options.deflection = TakeOut::kFull;
  Compensate(options, ForcesOf(plan), plan);
  const PlannedPoint& point = plan.passes[0].points[7];
  const Vector3d across = point.point.normal.cross(point.point.feed);
  EXPECT_GT(std::abs(point.compensation->across.expected), 0.01);
  EXPECT_LT(std::abs(Loaded(plan, point, point.point.engagement.force, across)), 1e-5);
  EXPECT_LT(std::abs(Loaded(plan, point, point.point.engagement.force, point.point.normal)), 1e-5);
  EXPECT_EQ(point.compensation->shift.dot(point.point.feed) < 1e-12, true);
}

TEST(Compensate, LeavesAirAndLeadsAlone) {
  PlanResult plan = Forced();
  plan.passes[0].points[0].point.kind = PointKind::kLeadIn;
  plan.passes[0].points[9].point.engagement = {};
  Compensate(Sure(), ForcesOf(plan), plan);
  EXPECT_EQ(plan.passes[0].points[0].compensation->shift, Vector3d::Zero());
  EXPECT_EQ(plan.passes[0].points[9].compensation->shift, Vector3d::Zero());
  EXPECT_EQ(Commanded(plan).passes[0].points[9].q, plan.passes[0].points[9].q);
  EXPECT_NE(Commanded(plan).passes[0].points[5].q, plan.passes[0].points[5].q);
}

TEST(Compensate, BoundsEveryShiftAndSaysSo) {
  PlanResult plan = Forced(4000);
  CompensationOptions options = Sure();
  options.most = 0.05;
  const CompensationCounts counts = Compensate(options, ForcesOf(plan), plan);
  EXPECT_GT(counts.cut, 0u);
  EXPECT_GT(counts.largest_cut, 0.05);
  size_t bounded = 0;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      EXPECT_LE(point.compensation->shift.norm(), 0.05 + 1e-12);
      bounded += point.compensation->bounded;
    }
  EXPECT_EQ(bounded, counts.cut);
}

TEST(Compensate, ALayersResidualIsCutByTheNextOne) {
  PlanResult plan = Forced();
  plan.passes.pop_back();  // the ring
  // The second pass runs below the first, and what that leaves standing adds to its depth.
  for (size_t i = 0; i < plan.passes[0].points.size(); ++i) {
    const PlannedPoint& below = plan.passes[1].points[i];
    plan.passes[0].points[i].point.position = below.point.position + below.point.normal;
  }
  CompensationOptions options = Sure();
  options.layers = 2;
  options.cutter_radius = 10;
  Compensate(options, ForcesOf(plan), plan);
  const PlannedPoint &above = plan.passes[0].points[5], &below = plan.passes[1].points[5];
  EXPECT_EQ(above.compensation->shift, Vector3d::Zero());  // roughing
  EXPECT_GT(above.compensation->normal.expected, 0.01);
  EXPECT_NEAR(below.compensation->force.norm() / below.point.engagement.force.norm(),
              1 + above.compensation->normal.expected, 1e-12);
  options.which = CompensatedLayers::kAll;
  Compensate(options, ForcesOf(plan), plan);
  EXPECT_GT(above.compensation->shift.norm(), 0.01);
  EXPECT_NEAR(below.compensation->force.norm(), below.point.engagement.force.norm(), 1e-9);
}

TEST(Compensate, WeightIsTakenOutEverywhereAndApart) {
  PlanResult plan = Forced();
  CompensationOptions options;
  const Vector3d sag(0, 0.01, -0.05);  // in B, whose axes are W's here
  options.weight = [&](const Joints&) { return sag; };
  Compensate(options, ForcesOf(plan), plan);
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      EXPECT_LT((point.compensation->shift + sag).norm(), 1e-12);
      EXPECT_EQ(point.compensation->normal.taken, 0);
      EXPECT_LT((TipAt(plan, point.compensation->q) - point.point.position + sag).norm(), 1e-9);
    }
}

TEST(Compensate, OffLeavesThePlanAsItIs) {
  PlanResult plan = Forced();
  const std::string before = Serialise(plan);
  Compensate(CompensationOptions(), ForcesOf(plan), plan);
  EXPECT_EQ(Serialise(plan), before);
  EXPECT_FALSE(IsCompensated(plan));
}

TEST(Compensate, OutlivesSerialisation) {
  PlanResult plan = Forced();
  Compensate(Sure(), ForcesOf(plan), plan);
  const std::string bytes = Serialise(plan);
  EXPECT_EQ(Serialise(ParsePlanResult(bytes, "plan.cbor")), bytes);
  EXPECT_TRUE(IsCompensated(ParsePlanResult(bytes, "plan.cbor")));
}

TEST(Compensate, APieceCanBeLeftNominal) {
  PlanResult plan = Forced();
  Compensate(Sure(), ForcesOf(plan), plan);
  LeaveNominal({}, 0, Segment(plan.passes[0].pieces[0]), plan);
  for (const PlannedPoint& point : plan.passes[0].points) EXPECT_EQ(point.compensation->q, point.q);
  EXPECT_TRUE(IsCompensated(plan));  // by the others
}

ArmDeviations SomeDeviations() {
  ArmDeviations deviations;
  for (size_t i = 0; i < 7; ++i) {
    const double k = static_cast<double>(i);
    deviations.shift[i] = 0.3 * Vector3d(std::cos(k), std::sin(2 * k), std::cos(3 * k));
    deviations.turn[i] = 4e-4 * Vector3d(std::sin(k), std::cos(2 * k), std::sin(3 * k));
  }
  return deviations;
}

/// How far the tool of the arm as it is lies, and is turned, from the nominal pose moved by the shift.
std::pair<double, double> OffOwn(const PlanResult& plan, const ArmDeviations& deviations,
                                 const PlannedPoint& point) {
  const Pose own = plan.X_WB * TrueFlange(plan.arm, deviations, point.compensation->q) * plan.X_FT,
             nominal = plan.X_WB * ForwardFlange(plan.arm, point.q) * plan.X_FT;
  return {(own.translation() - nominal.translation() - point.compensation->shift).norm(),
          (own.linear() - nominal.linear()).norm()};
}

TEST(Compensate, TheArmAsItIsComesToThePlannedPose) {
  PlanResult plan = Forced();
  CompensationOptions options;
  options.deviations = SomeDeviations();
  const CompensationCounts counts = Compensate(options, ForcesOf(plan), plan);
  EXPECT_TRUE(counts.out_of_reach.empty());
  EXPECT_GT(counts.largest_arm_shift, 0.3);
  EXPECT_EQ(counts.shifted, 0u);
  EXPECT_TRUE(HasCommanded(plan));
  EXPECT_FALSE(IsCompensated(plan));  // it may be run twice
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      const auto [tip, turn] = OffOwn(plan, *options.deviations, point);
      EXPECT_LT(tip, 1e-9);
      EXPECT_LT(turn, 1e-12);
      // What the controller is told: the nominal pose moved by arm_shift.
      EXPECT_LT(
          (TipAt(plan, point.compensation->q) - point.point.position - point.compensation->arm_shift).norm(),
          1e-9);
      EXPECT_GT(point.compensation->arm_turn.norm(), 1e-5);
    }
  const std::string bytes = Serialise(plan);
  EXPECT_EQ(Serialise(ParsePlanResult(bytes, "plan.cbor")), bytes);
}

TEST(Compensate, DeviationsStandBesideWhatForceAndWeightShift) {
  PlanResult plan = Forced(), plain = Forced();
  CompensationOptions options = Sure();
  Compensate(options, ForcesOf(plain), plain);
  options.deviations = SomeDeviations();
  Compensate(options, ForcesOf(plan), plan);
  EXPECT_TRUE(IsCompensated(plan));
  for (size_t p = 0; p < plan.passes.size(); ++p)
    for (size_t i = 0; i < plan.passes[p].points.size(); ++i) {
      const PlannedPoint& point = plan.passes[p].points[i];
      EXPECT_EQ(point.compensation->shift, plain.passes[p].points[i].compensation->shift);
      EXPECT_LT(OffOwn(plan, *options.deviations, point).first, 1e-9);
    }
  // Without its shifts a piece still is commanded for the arm as it is.
  LeaveNominal(options, 0, Segment(plan.passes[0].pieces[0]), plan);
  for (const PlannedPoint& point : plan.passes[0].points) {
    EXPECT_EQ(point.compensation->shift, Vector3d::Zero());
    EXPECT_LT(OffOwn(plan, *options.deviations, point).first, 1e-9);
  }
}

TEST(Compensate, WhatTheArmAsItIsDoesNotReachIsNamed) {
  PlanResult plan = Forced();
  const PlannedPoint& point = plan.passes[0].points[3];
  plan.arm.lower[0] = point.q[0];  // as far as the nominal arm has to go
  CompensationOptions options;
  options.deviations = ArmDeviations();
  options.deviations->turn[1].z() = 1e-3;  // joint 1's offset
  const CompensationCounts counts = Compensate(options, ForcesOf(plan), plan);
  EXPECT_FALSE(counts.out_of_reach.empty());
  for (const auto& [p, i] : counts.out_of_reach)
    EXPECT_EQ(plan.passes[p].points[i].compensation->q, plan.passes[p].points[i].q);
}

JointLaw SomeGears() {
  JointLaw law;
  law.harmonics = {{1, 1, 1e-4, 0.3}, {2, 170, 5e-5, 1}, {3, 2, 8e-5, -2}, {5, 100, 6e-5, 0}};
  law.couplings = {{3, 2, 4.5e-4}};
  return law;
}

TEST(Compensate, JointsThatErrAreCommandedByTheInverseOfTheirLaw) {
  PlanResult plan = Forced();
  CompensationOptions options;
  options.deviations = ArmDeviations();
  options.deviations->law = SomeGears();
  const CompensationCounts counts = Compensate(options, ForcesOf(plan), plan);
  EXPECT_GT(counts.largest_gear_shift, 0.1);
  EXPECT_LT(counts.largest_arm_shift, 1e-6);
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) {
      EXPECT_LT((options.deviations->law.At(point.compensation->q) - point.q).cwiseAbs().maxCoeff(), 1e-10);
      EXPECT_GT((point.compensation->q - point.q).cwiseAbs().maxCoeff(), 1e-5);
      EXPECT_LT((point.compensation->gear_shift - point.compensation->arm_shift).norm(), 1e-6);
    }
  const std::string bytes = Serialise(plan);
  EXPECT_EQ(Serialise(ParsePlanResult(bytes, "plan.cbor")), bytes);
}

TEST(Compensate, FramesAndJointsOfTheArmAreToldApart) {
  PlanResult frames = Forced(), both = Forced();
  CompensationOptions options;
  options.deviations = SomeDeviations();
  Compensate(options, ForcesOf(frames), frames);
  options.deviations->law = SomeGears();
  Compensate(options, ForcesOf(both), both);
  for (size_t p = 0; p < both.passes.size(); ++p)
    for (size_t i = 0; i < both.passes[p].points.size(); ++i) {
      const PlannedPoint &all = both.passes[p].points[i], &without = frames.passes[p].points[i];
      EXPECT_LT(OffOwn(both, *options.deviations, all).first, 1e-7);
      EXPECT_TRUE(without.compensation->gear_shift.isZero(0.0));
      const Vector3d by_frames = all.compensation->arm_shift - all.compensation->gear_shift;
      EXPECT_LT((by_frames - without.compensation->arm_shift).norm(), 1e-6);
    }
}

// Joint 1 stands by some 1e-3 ahead of its controller (behind it where negative), and may go by `room` beyond
// where the plan has it.
bool StaysWithin(double ahead, double room) {
  PlanResult plan = Forced();
  double most = -10;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) most = std::max(most, point.q[0]);
  plan.arm.upper[0] = most + room;
  CompensationOptions options;
  options.deviations = ArmDeviations();
  options.deviations->law.harmonics = {{1, 0.1, std::abs(ahead), ahead > 0 ? 1.570796 : -1.570796}};
  return Compensate(options, ForcesOf(plan), plan).out_of_reach.empty();
}

TEST(Compensate, LimitsHoldForTheArmsJointsAndForItsControllers) {
  EXPECT_TRUE(StaysWithin(1e-3, 5e-4));
  EXPECT_FALSE(StaysWithin(-1e-3, 5e-4)) << "the controller has to be told more than its limit";
  EXPECT_FALSE(StaysWithin(1e-3, -5e-4)) << "the arm goes farther than its controller has it";
}

TEST(Compensate, SwappedTwiceIsTheSame) {
  PlanResult plan = Forced();
  CompensationOptions options;
  options.deviations = SomeDeviations();
  Compensate(options, ForcesOf(plan), plan);
  const std::string before = Serialise(plan);
  SwapCommanded(plan.passes);
  EXPECT_NE(Serialise(plan), before);
  SwapCommanded(plan.passes);
  EXPECT_EQ(Serialise(plan), before);
  ForgetCommanded(plan.passes);
  EXPECT_EQ(Serialise(plan), Serialise(Forced()));
}

}  // namespace
}  // namespace millpose
