// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/program/left_out.hpp"

#include <gtest/gtest.h>

namespace millpose {
namespace {

/// The distance (mm) and angle (rad) of a pose from the straight motion between two targets, by Eigen's
/// slerp.
std::pair<double, double> OffLine(const Motion& a, const Motion& b, const Pose& pose) {
  const Eigen::Vector3d from = a.X_PT.translation(), along = b.X_PT.translation() - from;
  const double s = std::clamp((pose.translation() - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  const Eigen::Quaterniond first(a.X_PT.linear()), last(b.X_PT.linear()), at(pose.linear());
  return {(from + s * along - pose.translation()).norm(), first.slerp(s, last).angularDistance(at)};
}

}  // namespace

LeftOut MeasureLeftOut(const MotionProgram& planned, const MotionProgram& written) {
  LeftOut worst;
  size_t k = 0;
  for (const Motion& motion : planned.motions) {
    if (k == written.motions.size()) break;
    const Motion& kept = written.motions[k];
    if (motion.pass == kept.pass && motion.point == kept.point &&
        motion.X_PT.matrix() == kept.X_PT.matrix()) {
      ++k;
      continue;
    }
    EXPECT_FALSE(motion.exact);
    EXPECT_GE(motion.point, 0);
    EXPECT_EQ(motion.feed, kept.feed);
    const auto [position, angle] = OffLine(written.motions[k - 1], kept, motion.X_PT);
    worst.position = std::max(worst.position, position);
    worst.angle = std::max(worst.angle, angle);
    ++worst.count;
  }
  EXPECT_EQ(k, written.motions.size());
  return worst;
}

}  // namespace millpose
