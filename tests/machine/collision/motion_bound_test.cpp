// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/motion_bound.hpp"

#include "machine/robot/kinematics.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

TEST(MotionBound, HoldsForEveryPointOfTheBoxAndIsNotLoose) {
  const Arm arm = SampleArm();
  RandomStream random(13, 0);
  double tightest = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Joints q = RandomJoints(random, arm);
    Joints turn;
    for (int i = 0; i < 6; ++i) turn[i] = random.Uniform(0, 0.2);
    if (trial % 2 == 0) turn *= 0.01;
    const int link = 1 + random.Below(6);
    const Pose X_LG = RandomPose(random, 300);
    const Eigen::Vector3d half{random.Uniform(1, 200), random.Uniform(1, 200), random.Uniform(1, 200)};
    const auto frames = LinkFrames(arm, q);
    const Pose X = frames[link] * X_LG;
    const auto bounds =
        MotionBounds(AxesOf(frames), link, X.translation(), X.linear() * half.asDiagonal(), turn);
    for (int k = 0; k < 30; ++k) {
      Joints moved = q;
      for (int i = 0; i < 6; ++i)
        moved[i] += k < 20 ? turn[i] * (random.Below(2) * 2 - 1) : random.Uniform(-turn[i], turn[i]);
      const auto after = LinkFrames(arm, moved);
      const Eigen::Vector3d corner{half.x() * (random.Below(2) * 2 - 1), half.y() * (random.Below(2) * 2 - 1),
                                   half.z() * (random.Below(2) * 2 - 1)};
      for (int from = 0; from < link; ++from) {
        // Seen from link `from`: joints up to it stand still.
        const Eigen::Vector3d p0 = frames[from].inverse() * (frames[link] * (X_LG * corner));
        const Eigen::Vector3d p1 = after[from].inverse() * (after[link] * (X_LG * corner));
        ASSERT_LE((p1 - p0).norm(), bounds[from] + 1e-9) << "link " << link << " from " << from;
        tightest = std::max(tightest, (p1 - p0).norm() / bounds[from]);
      }
    }
    for (int from = link; from < 7; ++from) EXPECT_EQ(bounds[from], 0);
  }
  EXPECT_GT(tightest, 0.9);
}

}  // namespace
}  // namespace millpose::test
