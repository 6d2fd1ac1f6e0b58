// SPDX-License-Identifier: GPL-3.0-or-later
#include "robot/mechanism.hpp"

#include <gtest/gtest.h>

#include <kdl/joint.hpp>

#include "base/random.hpp"

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
    axis.compliance = axis.kind == AxisKind::kLinear ? 1e-5 : 1e-11;
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

TEST(Mechanism, MovesNothingAtZero) {
  RandomStream random(2, 0);
  const Mechanism mechanism = RandomMechanism(random);
  for (const Carries carried : {Carries::kRobot, Carries::kWorkpiece})
    EXPECT_TRUE(mechanism.Moved(carried, {0, 0, 0}).matrix().isIdentity(1e-12));
  EXPECT_TRUE(Mechanism().Moved(Carries::kRobot, {}).matrix().isIdentity(0));
}

}  // namespace
}  // namespace millpose
