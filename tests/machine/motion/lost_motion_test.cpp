// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/motion/lost_motion.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose {
namespace {

constexpr double kArcmin = kRadPerDeg / 60;

LostMotion LinkMove(double arcmin) {
  LostMotion lost;
  lost.width.head<6>().setConstant(arcmin * kArcmin);
  return lost;
}

/// A way on which one gear goes through `degrees`, by `step` at most, others standing.
std::vector<GearPlace> Way(const std::vector<double>& degrees, double step, int gear = 0) {
  std::vector<GearPlace> way;
  const auto add = [&](double angle) {
    way.emplace_back();
    way.back().at[gear] = DegToRad(angle);
  };
  add(degrees[0]);
  for (size_t i = 1; i < degrees.size(); ++i) {
    const double by = degrees[i] - degrees[i - 1];
    const int count = std::max(1, static_cast<int>(std::ceil(std::abs(by) / step)));
    for (int k = 1; k <= count; ++k) add(degrees[i - 1] + by * k / count);
  }
  return way;
}

size_t Crossings(const std::vector<GearEvent>& events, int gear) {
  return static_cast<size_t>(std::ranges::count_if(
      events, [&](const GearEvent& event) { return event.gear == gear && event.crosses; }));
}

size_t Turns(const std::vector<GearEvent>& events, int gear) {
  return static_cast<size_t>(std::ranges::count_if(
      events, [&](const GearEvent& event) { return event.gear == gear && event.turns; }));
}

// One joint 0 → 1 → 0° with 0.3 arcmin: the tip's error along n steps by h·R at 1°.
TEST(LostMotion, StepsByGapTimesLeverWhereAJointTurnsBack) {
  const LostMotion lost = LinkMove(0.3);
  const std::vector<GearPlace> way = Way({0, 1, 0}, 0.01);
  const std::vector<GearValues> offsets = OffsetsAlong(lost, way);
  constexpr double kRadius = 2000;  // mm
  GearValues levers = GearValues::Zero();
  levers[0] = kRadius;
  std::vector<double> errors;
  for (const GearValues& offset : offsets) errors.push_back(levers.dot(offset));
  const double mark = lost.width[0] * kRadius;
  EXPECT_NEAR(mark, 0.1745, 1e-4);
  for (size_t t = 0; t <= 100; ++t) EXPECT_NEAR(errors[t], -mark / 2, 1e-12) << t;
  for (size_t t = 101; t < errors.size(); ++t) EXPECT_NEAR(errors[t], mark / 2, 1e-12) << t;
  const std::vector<GearEvent> events = GearEvents(lost, way);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].place, 100u);
  EXPECT_EQ(events[0].gear, 0);
  EXPECT_TRUE(events[0].turns && events[0].crosses);
}

TEST(LostMotion, IsThePlayOperatorWithoutLoad) {
  const LostMotion lost = LinkMove(0.6);
  const double half = lost.width[0] / 2;
  RandomStream random(7, 0);
  std::vector<GearPlace> way(400);
  for (size_t t = 1; t < way.size(); ++t)
    for (int i = 0; i < 6; ++i) way[t].at[i] = way[t - 1].at[i] + (random.Uniform() - 0.5) * 3 * half;
  const std::vector<GearValues> offsets = OffsetsAlong(lost, way);
  const GearValues first = FirstMove(lost, way);
  for (int i = 0; i < 6; ++i) {
    double y = way[0].at[i] + (first[i] < 0 ? half : -half);
    for (size_t t = 0; t < way.size(); ++t) {
      y = std::clamp(y, way[t].at[i] - half, way[t].at[i] + half);
      ASSERT_NEAR(offsets[t][i], y - way[t].at[i], 1e-12);
    }
  }
}

TEST(LostMotion, CountsTwiceATurnOfACircle) {
  const LostMotion lost = LinkMove(0);
  std::vector<GearPlace> way;
  for (int t = 0; t <= 3 * 360; ++t) {
    way.emplace_back();
    way.back().at[0] = 0.1 * std::sin(DegToRad(t + 20));
  }
  EXPECT_EQ(Turns(GearEvents(lost, way), 0), 6u);
  // The same places however finely the way is cut.
  std::vector<GearPlace> coarse;
  for (size_t t = 0; t < way.size(); t += 10) coarse.push_back(way[t]);
  EXPECT_EQ(Turns(GearEvents(lost, coarse), 0), 6u);
}

TEST(LostMotion, LeavesOutWhatIsNotToldFromRest) {
  const LostMotion lost = LinkMove(0.3);
  EXPECT_TRUE(GearEvents(lost, Way({0, 1, 0.9951, 2}, 0.01)).empty());
  EXPECT_EQ(Turns(GearEvents(lost, Way({0, 1, 0.9949, 2}, 0.01)), 0), 2u);
  EXPECT_TRUE(GearEvents(lost, Way({0, -0.004, 1}, 0.001)).empty()) << "the first move is settled";
}

// Gravity presses it to one flank: it turns back and does not cross.
TEST(LostMotion, ALoadedJointThatTurnsBackNeedNotCross) {
  LostMotion lost = LinkMove(0.3);
  lost.friction[1] = 1e5;
  std::vector<GearPlace> way = Way({0, 1, 0}, 0.1, 1);
  for (GearPlace& place : way) place.load[1] = -3e5;
  for (const GearValues& offset : OffsetsAlong(lost, way)) EXPECT_EQ(offset[1], -lost.width[1] / 2);
  std::vector<GearEvent> events = GearEvents(lost, way);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_TRUE(events[0].turns);
  EXPECT_FALSE(events[0].crosses);
  for (GearPlace& place : way) place.load[1] = -0.9e5;  // below friction it does
  events = GearEvents(lost, way);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_TRUE(events[0].turns && events[0].crosses);
}

// Its weight's torque changes its sign on the way: it crosses, always going on.
TEST(LostMotion, ABalancedJointThatPassesItsDeadPointCrosses) {
  LostMotion lost = LinkMove(0.3);
  lost.friction[1] = 1e5;
  std::vector<GearPlace> way = Way({-10, 10}, 0.5, 1);
  for (GearPlace& place : way) place.load[1] = 1e6 * place.at[1];  // 0 at 0°
  const std::vector<GearEvent> events = GearEvents(lost, way);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_FALSE(events[0].turns);
  EXPECT_TRUE(events[0].crosses);
  EXPECT_NEAR(RadToDeg(way[events[0].place].at[1]), 6, 1e-9) << "the first above friction, 5.7°";
  const std::vector<GearValues> offsets = OffsetsAlong(lost, way);
  EXPECT_EQ(offsets.front()[1], -lost.width[1] / 2);
  EXPECT_EQ(offsets.back()[1], lost.width[1] / 2);
  const std::vector<GearPlace> back(way.rbegin(), way.rend());
  EXPECT_EQ(Crossings(GearEvents(lost, back), 1), 1u);
  for (GearPlace& place : way) place.load[1] = -place.load[1];  // pressed the way that going on drives it
  EXPECT_EQ(Crossings(GearEvents(lost, way), 1), 1u);
}

// A parallelogram: the third gear turns by A2 + A3 and stands while the two go against each other.
TEST(LostMotion, ReversalsCountAtTheGear) {
  Matrix6 gears = Matrix6::Identity();
  gears(2, 1) = 1;
  LostMotion lost = LinkMove(0.3);
  lost.CountAs({gears, Joints::Constant(0.5)});
  std::vector<GearPlace> way;
  for (const double angle : {0.0, 0.5, 1.0, 0.5, 0.0}) {
    way.emplace_back();
    way.back().at = AtGears(lost, (Joints() << 0, angle, -angle, 0, 0, 0).finished());
  }
  const std::vector<GearEvent> events = GearEvents(lost, way);
  EXPECT_EQ(Turns(events, 1), 1u);
  EXPECT_EQ(Turns(events, 2), 0u);
  EXPECT_EQ(Turns(GearEvents(LinkMove(0.3), way), 2), 0u);
}

// Levers by the gears say the same of the tip as the Jacobian by the axes.
TEST(LostMotion, LeversAreTheTipsWayPerTurnOfTheGear) {
  const Arm arm = test::SampleArm();
  Matrix6 matrix = Matrix6::Identity();
  matrix(2, 1) = 1;
  matrix(5, 4) = -0.5;
  LostMotion lost;
  lost.CountAs({matrix, Joints::Zero()});
  const Joints q = test::Degrees(10, -70, 95, 20, 40, -30);
  const Eigen::Vector3d tip(-250, 0, 250), normal = Eigen::Vector3d(1, 2, 3).normalized();
  const Joints by_joint = Jacobian(arm, q, tip).topRows<3>().transpose() * normal;
  const GearValues levers = GearLevers(lost, by_joint, {0.25});
  const Joints turn = 1e-6 * (Joints() << 1, -2, 3, -4, 5, -6).finished();  // of the axes
  const double by_gears = levers.dot(AtGears(lost, turn));
  const auto place = [&](const Joints& at) { return Eigen::Vector3d(ForwardFlange(arm, at) * tip); };
  EXPECT_NEAR(by_gears, normal.dot(place(q + turn / 2) - place(q - turn / 2)), 1e-9);
  EXPECT_EQ(levers[6], 0.25);
  EXPECT_EQ(levers[7], 0);
}

}  // namespace
}  // namespace millpose
