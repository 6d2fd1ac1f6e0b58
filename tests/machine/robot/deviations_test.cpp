// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/deviations.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

Joints DrawnAngles(std::mt19937& draw) {
  std::uniform_real_distribution<double> angle(-1.5, 1.5);
  Joints q;
  for (double& one : q) one = angle(draw);
  return q;
}

TEST(Deviations, NoneAreTheNominalArm) {
  std::mt19937 draw(1);
  const Arm arm = Kr500R2830();
  for (int i = 0; i < 20; ++i) {
    const Joints q = DrawnAngles(draw);
    EXPECT_TRUE(TrueFlange(arm, {}, q).isApprox(ForwardFlange(arm, q), 1e-13));
  }
}

// The axes of LinkFrames' header: z, y, y, x, y, z.
TEST(Deviations, ATurnAboutItsOwnAxisIsTheJointsOffset) {
  std::mt19937 draw(2);
  const Arm arm = Kr500R2830();
  constexpr int kAxes[] = {2, 1, 1, 0, 1, 2};
  for (Eigen::Index joint = 0; joint < 6; ++joint) {
    const auto at = static_cast<size_t>(joint);
    const Joints q = DrawnAngles(draw);
    ArmDeviations deviations;
    deviations.turn[at + 1][kAxes[at]] = 0.01;
    Joints offset = q;
    offset[joint] += arm.sign[at] * 0.01;
    EXPECT_TRUE(TrueFlange(arm, deviations, q).isApprox(ForwardFlange(arm, offset), 1e-12)) << joint;
  }
}

// What hangs behind a frame moves as one body: shift and turn of each add up, to first order.
TEST(Deviations, SmallOnesAddUp) {
  std::mt19937 draw(3);
  std::normal_distribution<double> part(0, 1);
  const Arm arm = Kr500R2830();
  const Joints q = DrawnAngles(draw);
  const std::array<Pose, 7> frames = LinkFrames(arm, q);
  constexpr double kSmall = 1e-5;
  ArmDeviations deviations;
  Vector3d moved = Vector3d::Zero();
  const Vector3d flange = frames[6].translation();
  for (size_t i = 0; i < 7; ++i) {
    deviations.shift[i] = kSmall * 1000 * Vector3d(part(draw), part(draw), part(draw));
    deviations.turn[i] = kSmall * Vector3d(part(draw), part(draw), part(draw));
    moved += frames[i].linear() * deviations.shift[i] +
             (frames[i].linear() * deviations.turn[i]).cross(flange - frames[i].translation());
  }
  const Vector3d got = TrueFlange(arm, deviations, q).translation() - flange;
  EXPECT_GT(moved.norm(), 1e-2);
  EXPECT_NEAR((got - moved).norm(), 0, 1e-4 * moved.norm());
}

// FK(IK(pose)) = pose, of the arm as it is.
TEST(Deviations, TheInverseBringsTheArmAsItIsThere) {
  std::mt19937 draw(4);
  std::normal_distribution<double> part(0, 1);
  const Arm arm = Kr500R2830();
  int reached = 0;
  for (int i = 0; i < 200; ++i) {
    ArmDeviations deviations;
    for (size_t k = 0; k < 7; ++k) {
      deviations.shift[k] = 0.5 * Vector3d(part(draw), part(draw), part(draw));
      deviations.turn[k] = 1e-3 * Vector3d(part(draw), part(draw), part(draw));
    }
    const Joints q = DrawnAngles(draw);
    const SingularityDistance far = DistanceToSingularity(arm, q);
    if (far.wrist < 0.1 || far.elbow < 0.1 || far.shoulder < 50) continue;
    const Pose target = ForwardFlange(arm, q);
    const auto found = TrueInverseNear(arm, deviations, target, Status(arm, q), q);
    ASSERT_TRUE(found) << i;
    ++reached;
    EXPECT_LT((TrueFlange(arm, deviations, *found).matrix() - target.matrix()).cwiseAbs().maxCoeff(), 1e-8);
    EXPECT_LT((*found - q).cwiseAbs().maxCoeff(), 0.2);
    EXPECT_GT((*found - q).cwiseAbs().maxCoeff(), 1e-5);
  }
  EXPECT_GT(reached, 50);
  // Out of reach: nothing.
  Pose far = Pose::Identity();
  far.translation() = Vector3d(9000, 0, 0);
  EXPECT_FALSE(TrueInverseNear(arm, {}, far, 0, Joints::Zero()));
}

}  // namespace
}  // namespace millpose
