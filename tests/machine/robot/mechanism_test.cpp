// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/mechanism.hpp"

#include <gtest/gtest.h>

#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "base/random.hpp"
#include "tests/machine/robot/arms.hpp"
#include "tests/machine/robot/kdl_chain.hpp"

namespace millpose {
namespace {

Eigen::Vector3d Vector(RandomStream& random) {
  return {random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
}

Mechanism RandomMechanism(RandomStream& random) {
  std::vector<ExternalAxis> axes(3);
  for (ExternalAxis& axis : axes) {
    axis.kind = random.Uniform() < 0.5 ? AxisKind::kLinear : AxisKind::kRotary;
    axis.carries = random.Uniform() < 0.5 ? Carries::kRobot : Carries::kWorkpiece;
    axis.direction = Vector(random).normalized();
    axis.origin = 1000 * Vector(random);
  }
  return Mechanism(axes);
}

ExternalPosition RandomPosition(const Mechanism& mechanism, RandomStream& random) {
  ExternalPosition position;
  for (const ExternalAxis& axis : mechanism.axes())
    position.push_back(axis.kind == AxisKind::kLinear ? random.Uniform(-2000, 2000) : random.Uniform(-3, 3));
  return position;
}

KDL::Vector Of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

// The same chain by KDL's joints, each about an axis that stands in W with all of them at 0.
Pose MovedByKdl(const Mechanism& mechanism, Carries carried, const ExternalPosition& position) {
  KDL::Frame frame = KDL::Frame::Identity();
  for (size_t i = 0; i < mechanism.axes().size(); ++i) {
    const ExternalAxis& axis = mechanism.axes()[i];
    if (axis.carries != carried) continue;
    const KDL::Joint joint("", Of(axis.origin), Of(axis.direction),
                           axis.kind == AxisKind::kLinear ? KDL::Joint::TransAxis : KDL::Joint::RotAxis);
    frame = frame * joint.pose(position[i]) * joint.pose(0).Inverse();
  }
  Pose pose = Pose::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose.linear()(row, column) = frame.M(row, column);
    pose.translation()[row] = frame.p(row);
  }
  return pose;
}

TEST(Mechanism, MovesAsAChainOfKdlDoes) {
  RandomStream random(1, 0);
  for (int i = 0; i < 200; ++i) {
    const Mechanism mechanism = RandomMechanism(random);
    const ExternalPosition position = RandomPosition(mechanism, random);
    for (const Carries carried : {Carries::kRobot, Carries::kWorkpiece}) {
      const Pose moved = mechanism.Moved(carried, position);
      EXPECT_LT((moved.matrix() - MovedByKdl(mechanism, carried, position).matrix()).cwiseAbs().maxCoeff(),
                1e-9);
    }
  }
}

KDL::Joint JointOf(const ExternalAxis& axis, double sense) {
  return KDL::Joint("", Of(axis.origin), Of(Eigen::Vector3d(sense * axis.direction)),
                    axis.kind == AxisKind::kLinear ? KDL::Joint::TransAxis : KDL::Joint::RotAxis);
}

KDL::Frame Of(const Pose& pose) {
  KDL::Frame frame;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) frame.M(row, column) = pose.linear()(row, column);
    frame.p[row] = pose.translation()[row];
  }
  return frame;
}

Pose RandomPose(RandomStream& random) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1),
                                     random.Uniform(0.1, 1))
                      .normalized()
                      .toRotationMatrix();
  pose.translation() = 1000 * Vector(random);
  return pose;
}

/// From the part over what carries it to the world, over what carries the robot to its base, along the arm to
/// the tip: one chain, its joints in that order.
struct WholeChain {
  KDL::Chain chain;
  std::vector<size_t> axes;  ///< external ones, as they come in it

  WholeChain(const Mechanism& mechanism, const Pose& X_WP, const Pose& X_WB, const KDL::Chain& arm) {
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), Of(X_WP).Inverse()));
    for (size_t i = mechanism.axes().size(); i-- > 0;)
      if (mechanism.axes()[i].carries == Carries::kWorkpiece) Add(mechanism.axes()[i], i, -1);
    for (size_t i = 0; i < mechanism.axes().size(); ++i)
      if (mechanism.axes()[i].carries == Carries::kRobot) Add(mechanism.axes()[i], i, 1);
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), Of(X_WB)));
    chain.addChain(arm);
  }

 private:
  void Add(const ExternalAxis& axis, size_t index, double sense) {
    chain.addSegment(KDL::Segment(JointOf(axis, sense), KDL::Frame::Identity()));
    axes.push_back(index);
  }
};

TEST(Mechanism, ArmRailAndTableAreOneChainOfKdl) {
  const Eigen::Vector3d p_FT(-250, 31, 250);
  RandomStream random(4, 0);
  for (int k = 0; k < 300; ++k) {
    const Mechanism mechanism = RandomMechanism(random);
    const ExternalPosition position = RandomPosition(mechanism, random);
    const Arm arm = Kr500R2830();
    const Pose X_WP = RandomPose(random), X_WB = RandomPose(random);
    Joints q;
    for (int i = 0; i < 6; ++i) q[i] = random.Uniform(-3, 3);
    const WholeChain whole(mechanism, X_WP, X_WB, KdlChain(arm, p_FT));
    KDL::JntArray values(whole.chain.getNrOfJoints());
    for (size_t i = 0; i < whole.axes.size(); ++i) values(static_cast<unsigned>(i)) = position[whole.axes[i]];
    for (int i = 0; i < 6; ++i)
      values(static_cast<unsigned>(whole.axes.size()) + static_cast<unsigned>(i)) = q[i];
    KDL::Frame frame;
    KDL::Jacobian J(whole.chain.getNrOfJoints());
    ASSERT_EQ(KDL::ChainFkSolverPos_recursive(whole.chain).JntToCart(values, frame), 0);
    KDL::ChainJntToJacSolver differential(whole.chain);
    ASSERT_EQ(differential.JntToJac(values, J), 0);
    const Pose part = mechanism.Moved(Carries::kWorkpiece, position) * X_WP;
    const Pose base = mechanism.Moved(Carries::kRobot, position) * X_WB;
    const Eigen::Vector3d tip_W = base * (ForwardFlange(arm, q) * p_FT), tip = part.inverse() * tip_W;
    for (int row = 0; row < 3; ++row) ASSERT_NEAR(tip[row], frame.p[row], 1e-9 * 3000);
    // A rail moves the tip along itself; the part's table moves it the other way, as the part sees it.
    for (size_t i = 0; i < whole.axes.size(); ++i) {
      const auto [direction, origin] = mechanism.LineOf(whole.axes[i], position);
      const ExternalAxis& axis = mechanism.axes()[whole.axes[i]];
      const double sense = axis.carries == Carries::kRobot ? 1 : -1;
      const Eigen::Vector3d column =
          sense * (axis.kind == AxisKind::kLinear ? direction : direction.cross(tip_W - origin).eval());
      const Eigen::Vector3d seen = part.linear().transpose() * column;
      for (int row = 0; row < 3; ++row)
        ASSERT_NEAR(seen[row], J(static_cast<unsigned>(row), static_cast<unsigned>(i)), 1e-9 * 5000);
    }
  }
}

TEST(Mechanism, MovesNothingAtZero) {
  RandomStream random(2, 0);
  const Mechanism mechanism = RandomMechanism(random);
  for (const Carries carried : {Carries::kRobot, Carries::kWorkpiece})
    EXPECT_TRUE(mechanism.Moved(carried, {0, 0, 0}).matrix().isIdentity(1e-12));
  EXPECT_TRUE(Mechanism().Moved(Carries::kRobot, {}).matrix().isIdentity(0));
}

}  // namespace
}  // namespace millpose
