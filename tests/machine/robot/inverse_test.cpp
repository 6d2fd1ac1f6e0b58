// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/kinematics.hpp"
#include "tests/base/tier.hpp"
#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// Angle between two rotations, rad; exact for small ones.
double AngleBetween(const Pose& a, const Pose& b) {
  return (a.linear() - b.linear()).norm() / std::sqrt(2.0);
}

/// Largest difference of two joint vectors modulo full revolutions, rad.
double Apart(const Joints& a, const Joints& b) {
  double apart = 0;
  for (int i = 0; i < 6; ++i) apart = std::max(apart, std::abs(std::remainder(a[i] - b[i], 2 * kPi)));
  return apart;
}

class InverseOfArm : public testing::TestWithParam<Arm> {};
INSTANTIATE_TEST_SUITE_P(Inverse, InverseOfArm, testing::ValuesIn(AllArms()),
                         [](const auto& instance) { return "arm" + std::to_string(instance.index); });

TEST_P(InverseOfArm, SolvesWhatForwardMakes) {
  const Arm& arm = GetParam();
  RandomStream stream(11, 0);
  double worst_position = 0, worst_angle = 0;
  for (int k = 0; k < OfTier(8000, 100000); ++k) {
    const Joints original = RandomJoints(stream);
    const Pose X_BF = ForwardFlange(arm, original);
    const InverseResult result = Inverse(arm, X_BF);
    ASSERT_GT(result.count, 0);
    const SingularityDistance distance = DistanceToSingularity(arm, original);
    const bool regular = distance.wrist > 1e-5 && distance.elbow > 1e-5 && distance.shoulder > 0.01;
    double nearest = 10;
    int last_branch = -1;
    for (int s = 0; s < result.count; ++s) {
      const ArmSolution& solution = result.solutions[s];
      ASSERT_GT(solution.branch, last_branch);
      last_branch = solution.branch;
      const Pose again = ForwardFlange(arm, solution.q);
      worst_position = std::max(worst_position, (again.translation() - X_BF.translation()).norm());
      worst_angle = std::max(worst_angle, AngleBetween(again, X_BF));
      ASSERT_GT(solution.q.minCoeff(), -kPi);
      ASSERT_LE(solution.q.maxCoeff(), kPi);
      const double apart = Apart(solution.q, original);
      nearest = std::min(nearest, apart);
      if (regular) {
        ASSERT_EQ(Status(arm, solution.q), solution.branch) << k;
        ASSERT_EQ(apart < 1e-7, solution.branch == Status(arm, original)) << k << " " << apart;
      }
    }
    if (regular) {
      ASSERT_EQ(result.status, ReachStatus::kReached);
      ASSERT_LT(nearest, 1e-7) << k;
    }
  }
  EXPECT_LT(worst_position, 1e-6);
  EXPECT_LT(worst_angle, 1e-9);
}

TEST_P(InverseOfArm, HasAllEightWhereBothShouldersReach) {
  const Arm& arm = GetParam();
  // A wrist centre above the shoulder, off axis 1, is within reach from both sides.
  const double reach = arm.a2 + std::hypot(arm.d4, arm.dz);
  Pose X_BF = Pose::Identity();
  X_BF.linear() = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  X_BF.translation() =
      Vector3d(0.2 * reach, 0.1 * reach, arm.d1 + 0.6 * reach) + arm.d6 * X_BF.linear().col(2);
  const InverseResult result = Inverse(arm, X_BF);
  ASSERT_EQ(result.count, 8);
  for (int branch = 0; branch < 8; ++branch) {
    EXPECT_EQ(result.solutions[branch].branch, branch);
    EXPECT_EQ(Status(arm, result.solutions[branch].q), branch);
    EXPECT_LT((ForwardFlange(arm, result.solutions[branch].q).matrix() - X_BF.matrix()).norm(), 1e-9);
  }
}

TEST_P(InverseOfArm, OutOfReachIsAStatus) {
  const Arm& arm = GetParam();
  Pose far = Pose::Identity();  // the wrist centre is d6 below the flange
  far.translation() = Vector3d(ArmLength(arm) - arm.d6 + 0.001, 0, arm.d1 + arm.d6);
  EXPECT_EQ(Inverse(arm, far).status, ReachStatus::kUnreachable);
  EXPECT_EQ(Inverse(arm, far).count, 0);
  // The wrist centre at the front shoulder, nearer than the two links can fold; from behind it may be
  // reached.
  Pose near = Pose::Identity();
  near.translation() = Vector3d(arm.a1, 0, arm.d1 + arm.d6);
  const bool front_is_behind = arm.a1 < 0;
  const InverseResult folded = Inverse(arm, near);
  for (int s = 0; s < folded.count; ++s) EXPECT_EQ(folded.solutions[s].branch % 2, front_is_behind ? 0 : 1);
  EXPECT_FALSE(InverseNear(arm, far, 2, Joints::Zero()).has_value());
  Pose broken = far;
  broken.translation().x() = std::nan("");
  EXPECT_EQ(Inverse(arm, broken).status, ReachStatus::kUnreachable);
}

TEST_P(InverseOfArm, SingularPosesKeepThePoseAndSaySo) {
  const Arm& arm = GetParam();
  RandomStream stream(12, 0);
  const double phi = std::atan2(arm.dz, arm.d4);
  for (int k = 0; k < 300; ++k) {
    Joints inner = RandomJoints(stream);
    if (k % 3 == 0) inner[4] = k % 2 == 0 ? 0 : kPi;
    if (k % 3 == 1) inner[2] = k % 2 == 0 ? phi : phi + kPi;
    Joints q;
    for (int i = 0; i < 6; ++i) q[i] = arm.sign[i] * (inner[i] - arm.offset[i]);
    Pose X_BF = ForwardFlange(arm, q);
    if (k % 3 == 2)
      X_BF.translation() = Vector3d(0, arm.dy, arm.d1 + 0.7 * arm.a2) + arm.d6 * X_BF.linear().col(2);
    const InverseResult result = Inverse(arm, X_BF);
    ASSERT_GT(result.count, 0) << k;
    EXPECT_EQ(result.status, ReachStatus::kSingular) << k;
    for (int s = 0; s < result.count; ++s) {
      ASSERT_TRUE(result.solutions[s].q.allFinite());
      const Pose again = ForwardFlange(arm, result.solutions[s].q);
      EXPECT_LT((again.translation() - X_BF.translation()).norm(), 1e-6) << k;
      EXPECT_LT(AngleBetween(again, X_BF), 1e-9) << k;
    }
  }
}

TEST_P(InverseOfArm, NearFindsTheOriginalWithItsTurns) {
  const Arm& arm = GetParam();
  RandomStream stream(13, 0);
  for (int k = 0; k < 2000; ++k) {
    Joints original;
    for (int i = 0; i < 6; ++i) original[i] = stream.Uniform(-6, 6);
    Joints near = original;
    for (int i = 0; i < 6; ++i) near[i] += stream.Uniform(-0.3, 0.3);
    const auto found = InverseNear(arm, ForwardFlange(arm, original), Status(arm, original), near);
    ASSERT_TRUE(found.has_value());
    EXPECT_LT((*found - original).cwiseAbs().maxCoeff(), 1e-5) << k;
  }
}

TEST(Inverse, NearKeepsA4WhereA5IsZero) {
  const Arm arm = Kr500R2830();
  const Joints original = Degrees(12, -80, 100, 200, 0, 33);
  const auto found = InverseNear(arm, ForwardFlange(arm, original), Status(arm, original), original);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((*found - original).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(Inverse, NearKeepsTheSumOfTheParallelAnglesWhereA5IsZero) {
  const Arm arm = Ur10e();
  for (const double a5 : {0.0, 180.0}) {
    const Joints original = Degrees(12, -80, 100, -60, a5, 33);
    const auto found = InverseNear(arm, ForwardFlange(arm, original), Status(arm, original), original);
    ASSERT_TRUE(found.has_value());
    EXPECT_LT((*found - original).cwiseAbs().maxCoeff(), 1e-7);
  }
}

TEST(Inverse, AWristNearerToAxis1ThanItsOffsetIsOutOfReach) {
  for (const Arm& arm : {DoosanM1013(), Ur10e()}) {
    Pose X_BF = Pose::Identity();
    X_BF.translation() = Vector3d(0.999 * arm.dy, 0, arm.d1 + 400 + arm.d6);
    EXPECT_EQ(Inverse(arm, X_BF).status, ReachStatus::kUnreachable);
    X_BF.translation().x() = 1.001 * arm.dy;
    EXPECT_EQ(Inverse(arm, X_BF).count, 8);
  }
}

TEST(Inverse, FullTurnsAreAllWithinLimits) {
  const Joints lower = Degrees(-185, -130, -100, -350, -120, -350);
  const Joints upper = Degrees(185, 20, 144, 350, 120, 350);
  const std::vector<Joints> all = FullRevolutions(Degrees(178, -60, 100, 20, 30, -340), lower, upper);
  ASSERT_EQ(all.size(), 8u);  // A1, A4 and A6 twice each
  for (const Joints& q : all) {
    EXPECT_TRUE((q.array() >= lower.array()).all() && (q.array() <= upper.array()).all());
    EXPECT_LT(Apart(q, all[0]), 1e-12);
  }
  EXPECT_TRUE(FullRevolutions(Degrees(0, 30, 0, 0, 0, 0), lower, upper).empty());
}

TEST(Inverse, FullTurnsReachTheLimitsThemselves) {
  Joints lower = Joints::Constant(-1), upper = Joints::Constant(1);
  lower[3] = -2 * kPi;
  upper[3] = 2 * kPi;
  const std::vector<Joints> all = FullRevolutions(Joints::Zero(), lower, upper);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all.front()[3], lower[3]);
  EXPECT_EQ(all.back()[3], upper[3]);
}

}  // namespace
}  // namespace millpose
