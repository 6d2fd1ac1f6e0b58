// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/cut_check.hpp"

#include "machine/robot/kinematics.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

const Joints kMiddle = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);

Carrier CarrierOf(const Cell& cell) { return {cell.arm, cell.X_WB, cell.X_FT}; }

/// The smallest clearance on the straight motion, in many steps.
double WalkLine(const World& world, const Joints& q0, const Joints& q1, int steps, double bound) {
  const Carrier carrier = CarrierOf(world.cell());
  Checker checker(world);
  double smallest = bound;
  for (int i = 0; i <= steps; ++i) {
    const auto q = OnLine(carrier, q0, q1, static_cast<double>(i) / steps);
    if (q) smallest = std::min(smallest, checker.Clearance(*q, Phase::kCutting, bound));
  }
  return smallest;
}

/// A ball that the spindle's corner just misses or just meets somewhere on a motion.
Cell BallCell(const Joints& at, const Eigen::Vector3d& p_TB) {
  Cell cell = SampleCell();
  const Pose X_WT = ForwardFlange(cell.arm, at) * cell.X_FT;
  cell.bodies.push_back({"ball", BodyClass::kFixture, Mount::kWorld, 0, At(0, 0, 0), Sphere{20}});
  cell.bodies.back().X_MG.translation() = X_WT * p_TB;
  return cell;
}

TEST(CheckCut, WhatItCallsFreeIsFreeOnTheStraightMotion) {
  RandomStream random(31, 0);
  const Carrier carrier = CarrierOf(SampleCell());
  int free = 0, blocked = 0, different = 0;
  for (int trial = 0; trial < 400; ++trial) {
    Joints q0 = kMiddle, q1 = kMiddle;
    for (int i = 0; i < 6; ++i) {
      const double most = i < 3 ? 0.01 : 0.12;  // the wrist turns fast: the two motions differ by millimetres
      q0[i] += random.Uniform(-most, most);
      q1[i] += random.Uniform(-most, most);
    }
    // A ball somewhere beside the spindle, away from its bracket.
    const double around = random.Uniform(-0.8, 0.8), off = 80 + 20 + random.Uniform(0, 70);
    const World world(BallCell(kMiddle, {off * std::cos(around), off * std::sin(around), 300}));
    const double clearance = world.cell().clearances.free;
    Checker checker(world);
    const std::optional<CutProblem> problem = CheckCut(checker, carrier, q0, q1, 0.5);
    const double truth = WalkLine(world, q0, q1, 100, clearance + 5);
    if (!problem) {
      EXPECT_GE(truth, clearance - 0.5 - 1e-9);
      ++free;
    } else {
      EXPECT_LT(truth, clearance + 0.5) << Describe(checker, *problem);
      ++blocked;
    }
    different += !problem == checker.Between(q0, q1, Phase::kCutting, 0.5).has_value();
  }
  EXPECT_GT(free, 50);
  EXPECT_GT(blocked, 50);
  EXPECT_GT(different, 0) << "even turning of the joints and the straight motion always agree here";
}

TEST(CheckCut, NamesWhatIsInTheWayAndWhereTheBranchEnds) {
  const World world(BallCell(kMiddle, {70, 0, 250}));
  Checker checker(world);
  const Carrier carrier = CarrierOf(world.cell());
  const auto found = CheckCut(checker, carrier, kMiddle, kMiddle, 0.5);
  ASSERT_TRUE(found);
  const std::string problem = Describe(checker, *found);
  EXPECT_NE(problem.find("ball"), std::string::npos) << problem;
  // A5 changes its sign: no straight motion keeps the branch.
  Joints below = kMiddle, above = kMiddle;
  below[4] = DegToRad(-2), above[4] = DegToRad(2);
  const World empty(SampleCell());
  Checker free(empty);
  EXPECT_TRUE(CheckCut(free, carrier, below, above, 0.5));
}

TEST(Between, HoldsForEveryMotionInTheTube) {
  RandomStream random(32, 0);
  const Joints tube = Joints::Constant(4e-5);
  int free = 0, blocked = 0;
  for (int scene = 0; scene < 60; ++scene) {
    const double around = random.Uniform(-kPi, kPi);
    const World world(BallCell(kMiddle, {110.5 * std::cos(around), 110.5 * std::sin(around), 300}));
    Joints q1 = kMiddle;
    for (int i = 0; i < 6; ++i) q1[i] += random.Uniform(-0.01, 0.01);
    Checker checker(world);
    if (checker.Between(kMiddle, q1, Phase::kFree, 0.5, tube)) {
      ++blocked;
      continue;
    }
    ++free;
    for (int walk = 0; walk < 20; ++walk) {
      const double s = random.Uniform();
      Joints q = kMiddle + s * (q1 - kMiddle);
      for (int i = 0; i < 6; ++i) q[i] += random.Below(2) ? tube[i] : -tube[i];
      EXPECT_GE(checker.Clearance(q, Phase::kFree, 20), world.cell().clearances.free - 0.5 - 1e-9);
    }
  }
  EXPECT_GT(free, 10);
  EXPECT_GT(blocked, 10);
  // A tube that moves bodies by more than the reserve ends, and errs on the safe side.
  const World world(BallCell(kMiddle, {110.5, 0, 300}));
  Checker checker(world);
  EXPECT_FALSE(checker.Between(kMiddle, kMiddle, Phase::kFree, 0.5).has_value());
  EXPECT_TRUE(checker.Between(kMiddle, kMiddle, Phase::kFree, 0.5, Joints::Constant(0.01)).has_value());
}

}  // namespace
}  // namespace millpose::test
