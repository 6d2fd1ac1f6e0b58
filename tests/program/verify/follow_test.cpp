// SPDX-License-Identifier: GPL-3.0-or-later
// How far a tool lies from its path is told in three parts, each of which says how the tool was moved.
#include "program/verify/follow.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

Vector3d Direction(RandomStream& random) {
  const double x = random.Uniform(-1, 1), y = random.Uniform(-1, 1), z = random.Uniform(-1, 1);
  return Vector3d(x, y, z + 1e-3).normalized();
}

TEST(PathFollower, TellsATurnAboutTheToolFromATilt) {
  RandomStream random(31, 0);
  const VerifyOptions options;
  for (int i = 0; i < 300; ++i) {
    Pose place = Pose::Identity();
    place.linear() = AngleAxisd(random.Uniform(0, kPi), Direction(random)).toRotationMatrix();
    place.translation() = 500 * Direction(random);
    const double turn = random.Uniform(1e-6, 3), tilt = random.Uniform(1e-6, 3), off = random.Uniform(0, 5);
    const Vector3d tool = place.linear().col(2), across = tool.cross(Direction(random)).normalized();
    Pose pose = place;
    pose.linear() = AngleAxisd(tilt, across) * place.linear() * AngleAxisd(turn, Vector3d::UnitZ());
    pose.translation() += off * Direction(random);
    const PathDeviation apart = PathFollower({place}, 0, options).Off(pose);
    EXPECT_NEAR(apart.position, off, 1e-9);
    EXPECT_NEAR(apart.axis, tilt, 1e-9);
    EXPECT_NEAR(apart.rotation, turn, 1e-9);
  }
}

TEST(PathFollower, AToolThatPointsBackwardsIsOffByHalfATurn) {
  Pose place = Pose::Identity(), pose = place;
  pose.linear() = AngleAxisd(kPi, Vector3d::UnitX()).toRotationMatrix();
  const VerifyOptions options;
  const PathDeviation apart = PathFollower({place}, 0, options).Off(pose);
  EXPECT_NEAR(apart.axis, kPi, 1e-12);
  EXPECT_TRUE(std::isfinite(apart.rotation));
  EXPECT_FALSE(apart.Within(options));
}

}  // namespace
}  // namespace millpose
