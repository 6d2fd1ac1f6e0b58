// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/point_memory.hpp"

#include <gtest/gtest.h>

#include "machine/collision/world.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose {
namespace {

struct Tally {
  int free = 0, blocked = 0;
  CheckCounts counts;
};

/// Asks about poses of random points, all branches and some rotations, once as ever and once with what the
/// point remembers: the same answers.
void Compare(const World& world, const Eigen::Vector3d& near, Phase phase, uint64_t stream, Tally& tally) {
  const Cell& cell = world.cell();
  RandomStream random(11, stream);
  Checker plain(world), remembering(world);
  for (int point = 0; point < 60; ++point) {
    Pose X_WT = test::RandomPose(random, 150);
    X_WT.translation() += near;
    PointMemory memory;
    for (int turn = 0; turn < 8; ++turn) {
      const double rotation = random.Uniform(-kPi, kPi);
      const Pose turned = X_WT * Eigen::AngleAxisd(rotation, Eigen::Vector3d::UnitZ());
      const InverseResult found =
          Inverse(cell.arm, cell.X_WB.inverse(Eigen::Isometry) * turned * cell.X_FT.inverse(Eigen::Isometry));
      for (int s = 0; s < found.count; ++s) {
        const Joints& q = found.solutions[s].q;
        const auto expected = plain.At(q, phase);
        const auto sighting = remembering.Blocked(q, phase, {rotation, 0.5}, memory);
        ASSERT_EQ(sighting.has_value(), expected.has_value());
        ++(sighting ? tally.blocked : tally.free);
        if (!sighting) continue;
        const auto got = std::optional(remembering.Measure(*sighting));
        EXPECT_EQ(got->first, expected->first);
        EXPECT_EQ(got->second, expected->second);
        if (expected->distance > 0) {
          EXPECT_NEAR(got->distance, expected->distance, 1e-5);
        }
      }
    }
  }
  tally.counts += remembering.counts();
}

TEST(PointMemory, ChangesNoAnswer) {
  Cell cell = test::SampleCell();
  const Eigen::Vector3d part(1900, 0, 1100);
  Body workpiece{"workpiece", BodyClass::kWorkpiece, Mount::kWorkpiece,
                 0,           Pose::Identity(),      test::BoxMesh({250, 700, 120})};
  cell.X_WP = test::At(part.x(), part.y(), part.z());
  cell.bodies.push_back(workpiece);
  cell.bodies.push_back(
      {"post", BodyClass::kFixture, Mount::kWorld, 0, test::At(1500, 400, 1000), Cylinder{60, 2000}});
  const World world(cell);
  Tally tally;
  Compare(world, part + Eigen::Vector3d(0, 0, 60), Phase::kCutting, 1, tally);
  Compare(world, part, Phase::kFree, 2, tally);
  EXPECT_GT(tally.free, 100);
  EXPECT_GT(tally.blocked, 100);
  EXPECT_GT(tally.counts.pairs_saved, tally.counts.pairs / 4);
}

TEST(PointMemory, KnowsWhatDependsOnWhat) {
  // Round, but beside the axis: each rotation is its own.
  Cell cell = test::EmptyCell();
  cell.clearances = {1, 1};
  cell.bodies.push_back(
      {"arm of the tool", BodyClass::kSpindle, Mount::kTool, 0, test::At(300, 0, 50), Sphere{20}});
  const Pose X_WT = cell.X_WB * ForwardFlange(cell.arm, cell.home) * cell.X_FT;
  cell.bodies.push_back(
      {"ball", BodyClass::kFixture, Mount::kWorld, 0, Pose(X_WT * test::At(300, 0, 50)), Sphere{20}});
  const World world(cell);
  Checker checker(world);
  PointMemory memory;
  EXPECT_TRUE(checker.Blocked(cell.home, Phase::kFree, {0.0}, memory));
  const Pose turned = X_WT * Eigen::AngleAxisd(1, Eigen::Vector3d::UnitZ());
  const InverseResult found =
      Inverse(cell.arm, cell.X_WB.inverse(Eigen::Isometry) * turned * cell.X_FT.inverse(Eigen::Isometry));
  ASSERT_GT(found.count, 0);
  for (int s = 0; s < found.count; ++s)
    EXPECT_FALSE(checker.Blocked(found.solutions[s].q, Phase::kFree, {1.0}, memory));
}

}  // namespace
}  // namespace millpose
