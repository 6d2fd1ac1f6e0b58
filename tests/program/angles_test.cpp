// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/random.hpp"
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d RandomRotation(RandomStream& stream) {
  Eigen::Quaterniond q(stream.Normal(), stream.Normal(), stream.Normal(), stream.Normal());
  return q.normalized().toRotationMatrix();
}

TEST(Angles, KukaFlangeAtTheCalibrationPose) {
  const Joints q = (Joints() << 0, -90, 90, 0, 0, 0).finished() * kRadPerDeg;
  const Vector3d abc = AnglesZyx(ForwardFlange(SampleArm(), q).linear()) * kDegPerRad;
  EXPECT_NEAR(abc[0], 0, 1e-9);
  EXPECT_NEAR(abc[1], 90, 1e-9);
  EXPECT_NEAR(abc[2], 0, 1e-9);
}

TEST(Angles, KukaFlangeTurnsWithA6) {
  // With A4 = A5 = 0 the flange turns about its own z, the base's x, by Rx(−A6): at B = 90 that shows in C
  // alone.
  const Joints q = (Joints() << 0, -90, 90, 0, 0, 30).finished() * kRadPerDeg;
  const Vector3d abc = AnglesZyx(ForwardFlange(SampleArm(), q).linear()) * kDegPerRad;
  EXPECT_NEAR(abc[0], -90, 1e-9);
  EXPECT_NEAR(abc[1], 60, 1e-9);
  EXPECT_NEAR(abc[2], -90, 1e-9);
  const Matrix3d expected = Eigen::AngleAxisd(-30 * kRadPerDeg, Vector3d::UnitX()).toRotationMatrix() *
                            Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY()).toRotationMatrix();
  EXPECT_LT((FromAnglesZyx(abc * kRadPerDeg) - expected).norm(), 1e-9);
}

TEST(Angles, BothOrdersRoundTrip) {
  RandomStream stream(7, 0);
  for (int i = 0; i < 2000; ++i) {
    const Matrix3d R = RandomRotation(stream);
    EXPECT_LT((FromAnglesZyx(AnglesZyx(R)) - R).norm(), 1e-14);
    EXPECT_LT((FromAnglesZxz(AnglesZxz(R)) - R).norm(), 1e-14);
    EXPECT_LE(std::abs(AnglesZyx(R)[1]), kPi / 2 + 1e-12);
  }
}

TEST(Angles, RoundTripAtAndNearTheDegeneratePlace) {
  RandomStream stream(8, 0);
  for (const double off : {0.0, 1e-15, 1e-12, 1e-9, 1e-8, 1e-6, 1e-3}) {
    for (const double sign : {-1.0, 1.0}) {
      const double a = stream.Uniform(-3, 3), c = stream.Uniform(-3, 3);
      const Matrix3d zyx = FromAnglesZyx({a, sign * (kPi / 2 - off), c});
      EXPECT_LT((FromAnglesZyx(AnglesZyx(zyx)) - zyx).norm(), 2e-9) << off;
      const Matrix3d zxz = FromAnglesZxz({a, sign > 0 ? off : kPi - off, c});
      EXPECT_LT((FromAnglesZxz(AnglesZxz(zxz)) - zxz).norm(), 2e-9) << off;
    }
  }
}

TEST(Angles, SinumerikOrdersAreTheManuals) {
  // RPY: C about Z, B about the new Y, A about the new X. Euler: A about Z, B about the new X, C about the
  // new Z.
  const auto about = [](int axis, double angle) {
    return Eigen::AngleAxisd(angle, Vector3d::Unit(axis)).toRotationMatrix();
  };
  const Vector3d abc(0.3, -0.4, 1.1);
  EXPECT_LT((FromToolAngles(AngleOrder::kRpy, abc) - about(2, 1.1) * about(1, -0.4) * about(0, 0.3)).norm(),
            1e-14);
  EXPECT_LT((FromToolAngles(AngleOrder::kEuler, abc) - about(2, 0.3) * about(0, -0.4) * about(2, 1.1)).norm(),
            1e-14);
  // ORIRPY2: the other way round, A about X, B about the new Y, C about the new Z.
  EXPECT_LT((FromToolAngles(AngleOrder::kRpy2, abc) - about(0, 0.3) * about(1, -0.4) * about(2, 1.1)).norm(),
            1e-14);
  for (const AngleOrder order : {AngleOrder::kRpy, AngleOrder::kRpy2})
    EXPECT_LT((ToolAngles(order, FromToolAngles(order, abc)) - abc).norm(), 1e-14);
  // Beyond a revolution and where A and C are not unique the nearest stand for the same orientation.
  for (const Vector3d& near : {Vector3d(3.3, -0.4, 7.4), Vector3d(0.2, kPi / 2, -4)}) {
    const Eigen::Matrix3d R = FromToolAngles(AngleOrder::kRpy2, near);
    EXPECT_LT((ToolAnglesNear(AngleOrder::kRpy2, R, near) - near).norm(), 1e-6);
  }
}

TEST(ToolAxis, PutsTheNamedAxisAlongTheTool) {
  for (const auto& [name, axis] : kFrameAxisWords) {
    const Matrix3d R_TC = ToolAxis(axis);
    EXPECT_NEAR(R_TC.determinant(), 1, 1e-15) << name;
    EXPECT_LT((R_TC * R_TC.transpose() - Matrix3d::Identity()).norm(), 1e-15) << name;
    const double sign = name[0] == '-' ? -1 : 1;
    const Vector3d along = R_TC.col(name.back() - 'x') * sign;
    EXPECT_EQ(along, Vector3d::UnitZ()) << name;
    EXPECT_EQ(R_TC * DirectionOf(axis), Vector3d::UnitZ()) << name;
  }
  EXPECT_EQ(ToolAxis(FrameAxis::kZ), Matrix3d::Identity());
}

TEST(Turn, StatusAndTurnNameOneJointPosition) {
  const Arm arm = SampleArm();
  const AxisConvention axes =
      AxisConvention::OfSigns({1, -1, 1, 1, -1, 1}, (Joints() << 0, 0.5, 0, 0, 0, -1).finished());
  RandomStream stream(3, 0);
  int compared = 0;
  for (int i = 0; i < 500; ++i) {
    Joints q;
    for (int j = 0; j < 6; ++j) q[j] = stream.Uniform(arm.lower[j], arm.upper[j]);
    if ((axes.FromArm(q).cwiseAbs().array() > 2 * kPi).any()) continue;
    if (DistanceToSingularity(arm, q).wrist < 0.01) continue;
    const auto found = AnglesAt(arm, axes, ForwardFlange(arm, q), Status(arm, q), ControllerTurn(axes, q));
    ASSERT_TRUE(found);
    EXPECT_LT((*found - q).norm(), 1e-7);
    ++compared;
  }
  EXPECT_GT(compared, 300);
}

TEST(Turn, AtZeroTheTurnBitSendsNoJointRound) {
  const Arm arm = SampleArm();
  const AxisConvention axes;
  Joints q;
  q << 0, -1.2, 1.4, 0, 0.8, 0;
  for (const int flipped : {0, 1 << 0, 1 << 3, 1 << 5, 1 << 0 | 1 << 3 | 1 << 5}) {
    const auto found =
        AnglesAt(arm, axes, ForwardFlange(arm, q), Status(arm, q), ControllerTurn(axes, q) ^ flipped);
    ASSERT_TRUE(found);
    EXPECT_LT((*found - q).norm(), 1e-7) << flipped;
  }
}

TEST(Numbers, HaveNoNegativeZero) {
  EXPECT_EQ(Fixed(-0.00001, 4), "0.0000");
  EXPECT_EQ(Fixed(-0.00005001, 4), "-0.0001");
  EXPECT_EQ(Fixed(2.5, 0), "2");
  EXPECT_EQ(Short(-0.00001, 4), "0");
  EXPECT_EQ(Short(2076.5, 4), "2076.5");
  EXPECT_EQ(Short(-100, 4), "-100");
  EXPECT_EQ(Short(100, 0), "100");
}

}  // namespace
}  // namespace millpose
