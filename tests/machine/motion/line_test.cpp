// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/motion/line.hpp"

#include "machine/robot/kinematics.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

Carrier SampleCarrier() {
  const Cell cell = EmptyCell();
  return {cell.arm, At(10, 20, 30), cell.X_FT};
}

TEST(Line, InterpolationAgreesWithSlerp) {
  RandomStream random(1, 0);
  for (int i = 0; i < 200; ++i) {
    const Pose a = RandomPose(random, 100), b = RandomPose(random, 100);
    const double share = random.Uniform();
    const Pose X = PoseLine(a, b).At(share);
    const Eigen::Quaterniond expected =
        Eigen::Quaterniond(a.linear()).slerp(share, Eigen::Quaterniond(b.linear()));
    EXPECT_LT((X.linear() - expected.toRotationMatrix()).norm(), 1e-9);
    EXPECT_LT((X.translation() - (1 - share) * a.translation() - share * b.translation()).norm(), 1e-9);
    EXPECT_NEAR(AngleBetween(a.linear(), X.linear()), share * PoseLine(a, b).angle(), 1e-9);
    EXPECT_LT((PoseLine(a, b).At(1).matrix() - b.matrix()).norm(), 1e-9);
    EXPECT_LT((PoseLine(a, a).At(share).matrix() - a.matrix()).norm(), 1e-12);
  }
}

TEST(Line, HalfATurnIsInterpolatedToo) {
  Pose half = Pose::Identity();
  half.linear() = Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Pose X = PoseLine(Pose::Identity(), half).At(0.5);
  EXPECT_NEAR(AngleBetween(Eigen::Matrix3d::Identity(), X.linear()), kPi / 2, 1e-9);
}

TEST(Line, FollowedTipStaysOnTheLineAndOnTheBranch) {
  const Carrier carrier = SampleCarrier();
  const Joints q = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);
  const Pose start = carrier.ToolPose(q);
  const Pose end = start * At(30, -40, 120) * Pose(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()));
  const LineMotion motion = FollowLine(carrier, q, end, carrier.arm.lower, carrier.arm.upper);
  ASSERT_EQ(motion.problem, "");
  ASSERT_GE(motion.joints.size(), 27u);  // 130 mm in steps of at most 5 mm
  const double count = static_cast<double>(motion.joints.size() - 1);
  for (size_t i = 0; i < motion.joints.size(); ++i) {
    const Pose expected = PoseLine(start, end).At(static_cast<double>(i) / count);
    EXPECT_LT((carrier.ToolPose(motion.joints[i]).matrix() - expected.matrix()).norm(), 1e-6);
    EXPECT_EQ(Status(carrier.arm, motion.joints[i]), Status(carrier.arm, q));
  }
}

TEST(Line, KeepsFullTurns) {
  const Carrier carrier = SampleCarrier();
  Joints q = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);
  q[5] -= 2 * kPi;
  q[3] += 0;
  const LineMotion motion =
      FollowLine(carrier, q, carrier.ToolPose(q) * At(0, 0, 50), carrier.arm.lower, carrier.arm.upper);
  ASSERT_EQ(motion.problem, "");
  EXPECT_LT((motion.joints.back() - q).cwiseAbs().maxCoeff(), 0.2);
}

TEST(Line, EndsWithAReasonAtLimitsReachAndSingularities) {
  const Carrier carrier = SampleCarrier();
  const Joints q = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);
  const Pose start = carrier.ToolPose(q);
  Pose far = start;
  far.translation().x() += 3000;
  const LineMotion reach = FollowLine(carrier, q, far, carrier.arm.lower, carrier.arm.upper);
  EXPECT_NE(reach.problem, "");
  Joints tight = carrier.arm.upper;
  tight[1] = q[1] + 0.01;
  Pose down = start;
  down.translation().x() += 200;
  const LineMotion limit = FollowLine(carrier, q, down, carrier.arm.lower, tight);
  EXPECT_NE(limit.problem.find("A2 ="), std::string::npos) << limit.problem;
  EXPECT_NE(limit.problem.find("mm along the straight motion of 200.0 mm"), std::string::npos)
      << limit.problem;
  // Turning the wrist through A5 = 0 on one branch would swing A4 and A6 round.
  const Joints stretched = Degrees(10, -80, 100, 5, 3, 0);
  const Pose through = carrier.ToolPose(Degrees(10, -80, 100, 0.1, -3, 5));
  const LineMotion singular = FollowLine(carrier, stretched, through, carrier.arm.lower, carrier.arm.upper);
  EXPECT_NE(singular.problem.find("singularity"), std::string::npos) << singular.problem;
}

TEST(Line, HalfwayDeviationVanishesWithTheSquareOfTheStep) {
  const Carrier carrier = SampleCarrier();
  const Joints q = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);
  Joints direction;
  direction << 0.03, -0.05, 0.04, 0.1, -0.08, 0.06;
  const Deviation large = HalfwayDeviation(carrier, q, q + direction);
  const Deviation small = HalfwayDeviation(carrier, q, q + 0.5 * direction);
  EXPECT_GT(large.position, 0.1);
  EXPECT_NEAR(large.position / small.position, 4, 0.5);
  EXPECT_NEAR(HalfwayDeviation(carrier, q, q).position, 0, 1e-9);
  // A1 alone moves the tip on an arc about a vertical axis.
  Joints turned = q;
  turned[0] += 0.1;
  const Eigen::Vector3d tip = carrier.X_WB.inverse() * carrier.ToolPose(q).translation();
  EXPECT_NEAR(HalfwayDeviation(carrier, q, turned).position, tip.head<2>().norm() * (1 - std::cos(0.05)),
              1e-9);
}

}  // namespace
}  // namespace millpose::test
