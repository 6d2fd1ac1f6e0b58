// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/joint_law.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"
#include "base/units.hpp"
#include "machine/robot/deviations.hpp"
#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace {

Joints WithinTurns(RandomStream& stream, double most) {
  Joints q;
  for (double& one : q) one = stream.Uniform(-most, most);
  return q;
}

/// A law with so many waves and couplings, whose steepest slope is `slope`.
JointLaw DrawnLaw(RandomStream& stream, int waves, int couplings, double slope) {
  JointLaw law;
  const auto joint = [&] { return 1 + static_cast<int>(5.999 * stream.Uniform()); };
  for (int i = 0; i < waves; ++i)
    law.harmonics.push_back({joint(), stream.Uniform(0.1, 300), 0, stream.Uniform(-kPi, kPi)});
  for (JointHarmonic& wave : law.harmonics) wave.amplitude = stream.Uniform(0.1, 1) / wave.harmonic;
  for (int i = 0; i < couplings; ++i) law.couplings.push_back({joint(), joint(), stream.Uniform(-1, 1)});
  const double scale = slope / law.SteepestSlope();
  for (JointHarmonic& wave : law.harmonics) wave.amplitude *= scale;
  for (JointCoupling& pair : law.couplings) pair.factor *= scale;
  return law;
}

TEST(JointLaw, WavesCountAlongTheJointsOwnTurn) {
  JointLaw law;
  law.harmonics = {{2, 3, 1e-3, DegToRad(30)}};
  Joints q = Joints::Zero();
  EXPECT_NEAR(law.At(q)[1], 0.5e-3, 1e-18);
  q[1] = DegToRad(20);  // 3 · 20 + 30 = 90
  EXPECT_NEAR(law.At(q)[1], q[1] + 1e-3, 1e-16);
  q[1] = DegToRad(20 + 120);  // a third of a turn later
  EXPECT_NEAR(law.At(q)[1], q[1] + 1e-3, 1e-15);
  q[1] = DegToRad(20 - 60);
  EXPECT_NEAR(law.At(q)[1], q[1] - 1e-3, 1e-15);
  for (const Eigen::Index other : {0, 2, 3, 4, 5}) EXPECT_EQ(law.At(q)[other], 0);
}

TEST(JointLaw, FollowersTurnWithOthers) {
  JointLaw law;
  law.couplings = {{3, 2, 4.5e-4}};
  Joints q = Joints::Constant(0.7);
  q[1] = -1.2;
  EXPECT_NEAR(law.At(q)[2], 0.7 - 5.4e-4, 1e-16);
  q[2] = 0;
  EXPECT_NEAR(law.Invert(law.At(q))[2], 0, 1e-16);
}

TEST(JointLaw, NoneLeavesEveryBit) {
  RandomStream stream(1, 0);
  for (int round = 0; round < 20; ++round) {
    const Joints q = WithinTurns(stream, 6);
    EXPECT_EQ(JointLaw().At(q), q);
    EXPECT_EQ(JointLaw().Invert(q), q);
    EXPECT_EQ(JointLaw().MostTurn(q.cwiseAbs()), q.cwiseAbs());
  }
}

TEST(JointLaw, ItsSlopeIsThatOfDifferencesAndBelowItsBound) {
  RandomStream stream(2, 0);
  double steepest = 0;
  for (int round = 0; round < 200; ++round) {
    const JointLaw law = DrawnLaw(stream, 8, 3, 0.09);
    const Joints q = WithinTurns(stream, 4);
    const Matrix6 slope = law.Slope(q);
    for (Eigen::Index j = 0; j < 6; ++j) {
      constexpr double kStep = 1e-6;
      const Joints step = kStep * Joints::Unit(j);
      const Joints differences = (law.At(q + step) - law.At(q - step)) / (2 * kStep);
      EXPECT_LT((slope.col(j) - differences).cwiseAbs().maxCoeff(), 2e-8);
    }
    const double here = (slope - Matrix6::Identity()).cwiseAbs().rowwise().sum().maxCoeff();
    EXPECT_LE(here, 0.09 + 1e-12);
    steepest = std::max(steepest, here);
  }
  EXPECT_GT(steepest, 0.08);  // the bound is not idle
}

// The contraction that the header states holds for every law that is let in, however its waves lie.
TEST(JointLaw, IsInvertedToTheLastBits) {
  RandomStream stream(3, 0);
  for (int round = 0; round < 2000; ++round) {
    const JointLaw law = DrawnLaw(stream, 1 + round % 12, 1 + round % 4, 0.0999);
    const Joints q = WithinTurns(stream, 6);
    EXPECT_LT((law.Invert(law.At(q)) - q).cwiseAbs().maxCoeff(), 1e-14) << round;
  }
}

TEST(JointLaw, NoJointTurnsFartherThanItSays) {
  RandomStream stream(4, 0);
  double nearest = 0;
  for (int round = 0; round < 500; ++round) {
    const JointLaw law = DrawnLaw(stream, 4, 2, 0.09);
    const Joints q = WithinTurns(stream, 3), turn = WithinTurns(stream, 1e-3);
    const Joints turned = (law.At(q + turn) - law.At(q)).cwiseAbs(), most = law.MostTurn(turn.cwiseAbs());
    EXPECT_TRUE((turned.array() <= most.array() + 1e-15).all());
    nearest = std::max(nearest, (turned.array() / turn.array().abs()).maxCoeff());
  }
  EXPECT_GT(nearest, 1.04);  // more than the controller's own turn
}

TEST(JointLaw, TheArmAsItIsTurnsByItAndTheInverseKnowsIt) {
  RandomStream stream(5, 0);
  const Arm arm = Kr500R2830();
  int found = 0;
  for (int round = 0; round < 100; ++round) {
    ArmDeviations own;
    own.law = DrawnLaw(stream, 6, 2, 0.01);
    const Joints q = WithinTurns(stream, 1.4);
    const Pose by_law = ForwardFlange(arm, own.law.At(q));
    EXPECT_LT((TrueFlange(arm, own, q).matrix() - by_law.matrix()).cwiseAbs().maxCoeff(), 1e-9);
    for (size_t i = 0; i < 7; ++i) {
      own.shift[i] = 0.3 * Eigen::Vector3d(stream.Normal(), stream.Normal(), stream.Normal());
      own.turn[i] = 3e-4 * Eigen::Vector3d(stream.Normal(), stream.Normal(), stream.Normal());
    }
    if (DistanceToSingularity(arm, q).wrist < 0.1) continue;
    const Pose target = ForwardFlange(arm, q);
    const auto commanded = TrueInverseNear(arm, own, target, Status(arm, q), q);
    if (!commanded) continue;
    ++found;
    EXPECT_LT((TrueFlange(arm, own, *commanded).matrix() - target.matrix()).cwiseAbs().maxCoeff(), 1e-8);
  }
  EXPECT_GT(found, 60);
}

}  // namespace
}  // namespace millpose
