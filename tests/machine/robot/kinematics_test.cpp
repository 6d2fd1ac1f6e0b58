// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/kinematics.hpp"

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "machine/robot/compose.hpp"
#include "tests/machine/robot/arms.hpp"
#include "tests/machine/robot/kdl_chain.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

TEST(Kinematics, ForwardAndJacobianAgreeWithKdl) {
  const Vector3d p_FT(-250, 31, 250);
  RandomStream stream(1, 0);
  for (const Arm& arm : AllArms()) {
    const KDL::Chain chain = KdlChain(arm, p_FT);
    KDL::ChainFkSolverPos_recursive forward(chain);
    KDL::ChainJntToJacSolver differential(chain);
    for (int k = 0; k < 2000; ++k) {
      const Joints q = RandomJoints(stream);
      KDL::JntArray angles(6);
      angles.data = q;
      KDL::Frame frame;
      KDL::Jacobian J(6);
      ASSERT_EQ(forward.JntToCart(angles, frame), 0);
      ASSERT_EQ(differential.JntToJac(angles, J), 0);
      const Pose X_BF = ForwardFlange(arm, q);
      const Vector3d tip = X_BF * p_FT;
      for (int row = 0; row < 3; ++row) {
        EXPECT_NEAR(tip[row], frame.p[row], 1e-9 * 3000);
        for (int column = 0; column < 3; ++column)
          EXPECT_NEAR(X_BF.linear()(row, column), frame.M(row, column), 1e-12);
      }
      const Matrix6 own = Jacobian(arm, q, p_FT);
      ASSERT_LT((own - J.data).cwiseAbs().maxCoeff(), 1e-9 * 3000) << arm.name;
    }
  }
}

TEST(Compose, IsTheProductOfEigenToTheLastBit) {
  RandomStream stream(3, 0);
  for (int k = 0; k < 10000; ++k) {
    const Arm arm = Kr500R2830();
    const Pose a = ForwardFlange(arm, RandomJoints(stream)), b = ForwardFlange(arm, RandomJoints(stream));
    const Pose product = a * b;
    ASSERT_TRUE(Compose(a, b).matrix() == product.matrix()) << k;
  }
}

TEST(Kinematics, JacobianIsTheDerivativeOfTheTip) {
  const Vector3d p_FT(-250, 31, 250);
  const double step = 1e-5;
  RandomStream stream(2, 0);
  for (const Arm& arm : AllArms()) {
    for (int k = 0; k < 500; ++k) {
      const Joints q = RandomJoints(stream);
      const Matrix6 J = Jacobian(arm, q, p_FT);
      for (int i = 0; i < 6; ++i) {
        const Pose ahead = ForwardFlange(arm, q + step * Joints::Unit(i));
        const Pose back = ForwardFlange(arm, q - step * Joints::Unit(i));
        const Vector3d velocity = (ahead * p_FT - back * p_FT) / (2 * step);
        const Eigen::Matrix3d spin =
            (ahead.linear() - back.linear()) / (2 * step) * ForwardFlange(arm, q).linear().transpose();
        const Vector3d turn(spin(2, 1), spin(0, 2), spin(1, 0));
        ASSERT_LT((velocity - J.col(i).head<3>()).norm(), 1e-6 * (1 + velocity.norm())) << arm.name;
        ASSERT_LT((turn - J.col(i).tail<3>()).norm(), 1e-6);
      }
    }
  }
}

void ExpectFramesHangTogether(const Arm& arm, const std::array<double, 7>& distance) {
  RandomStream stream(3, 0);
  for (int k = 0; k < 100; ++k) {
    const std::array<Pose, 7> frames = LinkFrames(arm, RandomJoints(stream));
    for (int i = 1; i < 7; ++i) {
      EXPECT_NEAR((frames[i].translation() - frames[i - 1].translation()).norm(), distance[i], 1e-9);
      const Eigen::Matrix3d& R = frames[i].linear();
      EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
      EXPECT_GT(R.determinant(), 0);
    }
  }
}

TEST(Kinematics, LinkFramesHangTogether) {
  ExpectFramesHangTogether(Kr500R2830(), {0, 1045, 500, 1300, std::hypot(1025, 55), 0, 290});
  ExpectFramesHangTogether(DoosanM1013(), {0, 152.5, 34.5, 620, 559, 0, 121});
  ExpectFramesHangTogether(Ur10e(), {0, 180.7, 174.15, 612.7, 571.55, 119.85, 116.55});
}

TEST(Kinematics, AUrMovesAsItsDenavitHartenbergTableSays) {
  // a, alpha, d of each joint, Universal Robots' table of the UR10e.
  const double quarter = kPi / 2;
  const double table[6][3] = {{0, quarter, 180.7},  {-612.7, 0, 0},        {-571.55, 0, 0},
                              {0, quarter, 174.15}, {0, -quarter, 119.85}, {0, 0, 116.55}};
  RandomStream stream(4, 0);
  for (int k = 0; k < 500; ++k) {
    const Joints q = k == 0 ? Joints(Joints::Zero()) : RandomJoints(stream);
    KDL::Frame expected = KDL::Frame::Identity();
    for (int i = 0; i < 6; ++i)
      expected = expected * KDL::Frame::DH(table[i][0], table[i][1], table[i][2], q[i]);
    const Pose X_BF = ForwardFlange(Ur10e(), q);
    for (int row = 0; row < 3; ++row) {
      ASSERT_NEAR(X_BF.translation()[row], expected.p[row], 1e-9);
      for (int column = 0; column < 3; ++column)
        ASSERT_NEAR(X_BF.linear()(row, column), expected.M(row, column), 1e-12);
    }
  }
  // At joint angles 0 the arm lies stretched along −x.
  EXPECT_LT((ForwardFlange(Ur10e(), Joints::Zero()).translation() - Vector3d(-1184.25, -290.7, 60.85)).norm(),
            1e-9);
}

TEST(Kinematics, KukaHomeHasAbcZeroNinetyZero) {
  // A about Z, B about new Y, C about new X: {0, −90, 90, 0, 0, 0} is Rz(0)·Ry(90°)·Rx(0).
  for (const Arm& arm : {Kr500R2830(), Kr500R2800(), KrQuantecR2700()}) {
    const Pose X_BF = ForwardFlange(arm, Degrees(0, -90, 90, 0, 0, 0));
    Eigen::Matrix3d expected;
    expected << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    EXPECT_LT((X_BF.linear() - expected).norm(), 1e-15);
    const Vector3d position(arm.a1 + arm.d4 + arm.d6, 0, arm.d1 + arm.a2 + arm.dz);
    EXPECT_LT((X_BF.translation() - position).norm(), 1e-9);
  }
}

TEST(Kinematics, KukaPoseWithA6Turned) {
  // A6 = 30° turns the flange by −30° about its own z: Ry(90°)·Rz(−30°).
  const Pose X_BF = ForwardFlange(Kr500R2830(), Degrees(0, -90, 90, 0, 0, 30));
  const double c = std::sqrt(0.75), s = 0.5;
  Eigen::Matrix3d expected;
  expected << 0, 0, 1, -s, c, 0, -c, -s, 0;
  EXPECT_LT((X_BF.linear() - expected).norm(), 1e-15);
}

TEST(Kinematics, StatusAndTurnBits) {
  const Arm arm = Kr500R2830();
  EXPECT_EQ(Status(arm, Degrees(0, -90, 90, 0, 10, 0)), 2);
  EXPECT_EQ(Status(arm, Degrees(0, -90, 90, 0, -10, 0)), 6);
  EXPECT_EQ(Status(arm, Degrees(0, -130, 144, 0, 10, 0)), 2);
  EXPECT_EQ(Status(arm, Degrees(0, -130, -30, 0, 10, 0)), 1);
  const double phi = RadToDeg(std::atan2(-55, 1025));  // the elbow's bit changes at A3 = atan2(dz, d4)
  EXPECT_EQ(Status(arm, Degrees(0, -60, phi + 0.01, 0, 10, 0)), 2);
  EXPECT_EQ(Status(arm, Degrees(0, -60, phi - 0.01, 0, 10, 0)), 0);
  EXPECT_EQ(Turn(Degrees(1, -1, 0, -0.1, 5, -300)), 0b101010);
}

TEST(Kinematics, ParallelAxesAreSingularInTheSameThreeWays) {
  const Arm arm = Ur10e();
  const SingularityDistance at = DistanceToSingularity(arm, Degrees(20, -90, 90, 40, 30, 10));
  EXPECT_NEAR(at.wrist, 0.5, 1e-15);  // axes 4 and 6 are parallel at A5 = 0
  EXPECT_NEAR(at.elbow, 1, 1e-15);
  // Axis 5 points along −(A2 + A3 + A4 + 90°) = −130°.
  EXPECT_NEAR(at.shoulder, 571.55 + 119.85 * std::cos(DegToRad(130)), 1e-9);
  for (const double a5 : {0.0, 180.0})
    EXPECT_LT(std::abs(Jacobian(arm, Degrees(20, -90, 90, 40, a5, 10), Vector3d::Zero()).determinant()),
              1e-4);
}

TEST(Kinematics, DistancesToSingularities) {
  const Arm arm = Kr500R2830();
  const SingularityDistance at = DistanceToSingularity(arm, Degrees(20, -90, 90, 40, 30, 10));
  EXPECT_NEAR(at.wrist, 0.5, 1e-15);
  EXPECT_NEAR(at.elbow, 1025 / std::hypot(1025, 55), 1e-15);
  EXPECT_NEAR(at.shoulder, 1525, 1e-9);
  EXPECT_NEAR(DistanceToSingularity(arm, Degrees(0, -60, RadToDeg(std::atan2(-55, 1025)), 0, 0, 0)).elbow, 0,
              1e-15);
}

}  // namespace
}  // namespace millpose
