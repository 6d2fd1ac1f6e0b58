// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of the one convention: counted and back, chained, Jacobian and torques by the transpose.
#include "machine/robot/axis_convention.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"
#include "base/units.hpp"
#include "machine/robot/angles.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace {

Joints Some(RandomStream& random, double range) {
  Joints q;
  for (double& angle : q) angle = random.Uniform(-range, range);
  return q;
}

/// Signs, and couplings that lead from later axes to earlier ones alone.
AxisConvention Exact(RandomStream& random) {
  Matrix6 m = Matrix6::Zero();
  for (int i = 0; i < 6; ++i) {
    m(i, i) = random.Uniform() < 0.5 ? 1 : -1;
    for (int j = 0; j < i; ++j)
      if (random.Uniform() < 0.3) m(i, j) = random.Uniform() < 0.5 ? 1 : -1;
  }
  return {m, Some(random, 3)};
}

AxisConvention Geared(RandomStream& random) {
  Matrix6 m = Matrix6::Identity();
  for (int i = 0; i < 6; ++i) {
    m(i, i) = random.Uniform(0.5, 2) * (random.Uniform() < 0.5 ? 1 : -1);
    if (i > 0) m(i, i - 1) = random.Uniform(-0.9, 0.9);
  }
  return {m, Some(random, 3)};
}

TEST(AxisConvention, CountedAndBackIsWhatItWas) {
  RandomStream random(1, 0);
  for (int k = 0; k < 200; ++k) {
    for (const AxisConvention& axes : {Exact(random), Geared(random)}) {
      const Joints q = Some(random, 6);
      EXPECT_LT((axes.ToArm(axes.FromArm(q)) - q).cwiseAbs().maxCoeff(), 1e-13);
      EXPECT_LT((axes.Inverse().FromArm(axes.FromArm(q)) - q).cwiseAbs().maxCoeff(), 1e-13);
    }
    const AxisConvention exact = Exact(random);
    EXPECT_EQ(Matrix6(exact.matrix() * exact.Inverse().matrix()), Matrix6(Matrix6::Identity()))
        << "whole numbers stay whole";
  }
}

TEST(AxisConvention, SignsAndOffsetsGiveTheSameBitsAsOneByOne) {
  RandomStream random(2, 0);
  for (int k = 0; k < 200; ++k) {
    std::array<double, 6> signs{};
    for (double& sign : signs) sign = random.Uniform() < 0.5 ? 1 : -1;
    const Joints offset = Some(random, 3), q = Some(random, 6);
    const AxisConvention axes = AxisConvention::OfSigns(signs, offset);
    const Joints counted = axes.FromArm(q), back = axes.ToArm(q);
    for (int i = 0; i < 6; ++i) {
      EXPECT_EQ(counted[i], signs[static_cast<size_t>(i)] * q[i] + offset[i]);
      EXPECT_EQ(back[i], signs[static_cast<size_t>(i)] * (q[i] - offset[i]));
    }
  }
}

TEST(AxisConvention, OneAfterTheOther) {
  RandomStream random(3, 0);
  for (int k = 0; k < 200; ++k) {
    const AxisConvention inner = Geared(random), outer = Exact(random);
    const Joints q = Some(random, 6);
    EXPECT_LT((outer.After(inner).FromArm(q) - outer.FromArm(inner.FromArm(q))).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST(AxisConvention, InnerAnglesAreTheArmsOwnThroughIt) {
  RandomStream random(4, 0);
  for (const Arm& arm : AllArms()) {
    const Joints q = Some(random, 3);
    EXPECT_EQ(InnerConvention(arm).FromArm(q), InnerAngles(arm, q));
  }
}

TEST(AxisConvention, JacobianAndTorquesGoByTheTranspose) {
  RandomStream random(5, 0);
  for (const Arm& arm : AllArms()) {
    const AxisConvention axes = Geared(random);
    const Joints q = Some(random, 3), step = Some(random, 1);
    const Eigen::Vector3d tip(10, -20, 150);
    const Matrix6 J = Jacobian(arm, q, tip), counted = axes.CountJacobian(J);
    // A step of the counted angles moves the tip as the arm's own does.
    const Joints counted_step = axes.FromArm(q + step) - axes.FromArm(q);
    EXPECT_LT((counted * counted_step - J * step).norm(), 1e-9 * J.norm());
    // By differences of the forward kinematics.
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 6; ++i) {
      Joints away = axes.FromArm(q);
      away[i] += kStep;
      const Eigen::Vector3d moved = ForwardFlange(arm, axes.ToArm(away)) * tip - ForwardFlange(arm, q) * tip;
      EXPECT_LT((moved / kStep - counted.col(i).head<3>()).norm(), 1e-5 * J.norm());
    }
    // A force at the tip does the same work either way.
    const Joints force = Some(random, 100);
    const Joints torques = J.transpose() * force;
    EXPECT_LT((axes.CountTorques(torques) - counted.transpose() * force).norm(), 1e-9 * torques.norm());
    EXPECT_NEAR(axes.CountTorques(torques).dot(counted_step), torques.dot(step), 1e-9 * torques.norm());
  }
}

TEST(AxisConvention, AParallelogramsSpringActsOnTheAbsoluteAngle) {
  Matrix6 gears = Matrix6::Identity();
  gears(2, 1) = 1;  // the rod holds the forearm to the base: its spring feels A2 + A3
  const AxisConvention axes(gears, Joints::Zero());
  Joints k;
  k << 1, 2, 3, 4, 5, 6;
  const Matrix6 of_gears = k.asDiagonal();
  const Matrix6 K = axes.ArmStiffness(of_gears);
  RandomStream random(6, 0);
  for (int n = 0; n < 50; ++n) {
    const Joints bent = Some(random, 1);
    const double energy = k[0] * bent[0] * bent[0] + k[1] * bent[1] * bent[1] +
                          k[2] * (bent[1] + bent[2]) * (bent[1] + bent[2]) + k[3] * bent[3] * bent[3] +
                          k[4] * bent[4] * bent[4] + k[5] * bent[5] * bent[5];
    EXPECT_NEAR(bent.dot(K * bent), energy, 1e-12);
    // The springs' torques about the arm's axes, mapped, are the springs' own.
    EXPECT_LT((axes.CountTorques(K * bent) - of_gears * (axes.FromArm(bent) - axes.offset())).norm(), 1e-12);
  }
}

TEST(AxisConvention, FanucsThirdAxisCountsAgainstTheHorizontal) {
  // The cell's R-2000iC counts J3 from the upper arm; the controller does from the horizontal. Turning J2
  // alone while the controller's J3 stays must leave the forearm's lean in space as it is.
  Arm arm = Kr500R2830();
  arm.sign = {1, 1, -1, -1, -1, -1};
  arm.offset << 0, -kPi / 2, kPi / 2, 0, 0, 0;
  Matrix6 fanuc = Matrix6::Identity();
  fanuc(2, 1) = -1;
  const AxisConvention axes(fanuc, Joints::Zero());
  const Joints q = (Joints() << 0.3, 0.2, -0.4, 0.1, 0.5, -0.2).finished();
  EXPECT_DOUBLE_EQ(axes.FromArm(q)[2], q[2] - q[1]);
  const Eigen::Matrix3d forearm = LinkFrames(arm, q)[3].linear();
  Joints counted = axes.FromArm(q);
  counted[1] += 0.25;
  EXPECT_LT((LinkFrames(arm, axes.ToArm(counted))[3].linear() - forearm).norm(), 1e-12);
}

TEST(AxisConvention, WhatCannotBeUndoneIsNone) {
  Matrix6 m = Matrix6::Identity();
  m.row(2) = m.row(1);
  EXPECT_THROW(AxisConvention(m, Joints::Zero()), std::invalid_argument);
  m.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(AxisConvention(m, Joints::Zero()), std::invalid_argument);
}

}  // namespace
}  // namespace millpose
