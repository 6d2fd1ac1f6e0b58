// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/kept_pass.hpp"

#include <gtest/gtest.h>

#include "tests/pipeline/small_job.hpp"

namespace millpose {
namespace {

/// The small job in a cell with a post.
class Posts {
 public:
  Posts() : folder_("posts") { test::CopySmallJob(folder_); }

  PlannedJob Plan(const std::string& post, const CheckpointStore& checkpoints) {
    folder_.Write("cell.yaml", ReadFile(test::SamplePath("cells/kr500_r2830.yaml")));
    folder_.Change(
        "cell.yaml", "excluded_pairs: []",
        fmt::format("  - {{name: post, class: fixture, mount: world, {}}}\nexcluded_pairs: []", post));
    return PlanJob(LoadJobInputs(folder_.path() / "job.yaml", {}), checkpoints, {.threads = 1});
  }

 private:
  test::TestFolder folder_;
};

std::string Box(double x, double y, double z, double size = 100) {
  return fmt::format("shape: {{box: {{size_mm: [{0}, {0}, {0}]}}}}, pose: {{xyz_mm: [{1}, {2}, {3}]}}", size,
                     x, y, z);
}

TEST(KeptPass, AMovedFixtureCostsOnlyThePassesItMatters) {
  Posts posts;
  const test::MemoryCheckpoints kept;
  const PlannedJob first = posts.Plan(Box(-3000, 0, 50), kept);
  ASSERT_EQ(first.resumed_passes, 0);
  const size_t passes = first.plan.passes.size();

  const PlannedJob far = posts.Plan(Box(-3000, 1500, 50), kept);
  EXPECT_EQ(far.resumed_passes, passes);
  EXPECT_EQ(test::BytesOf(far), test::BytesOf(posts.Plan(Box(-3000, 1500, 50), NoCheckpoints())));

  const Eigen::Vector3d tip = first.plan.passes[0].points[0].point.position;
  const std::string near = Box(tip.x() - 150, tip.y(), tip.z() + 260);
  const PlannedJob close = posts.Plan(near, kept);
  EXPECT_EQ(close.resumed_passes, 0);
  EXPECT_EQ(test::BytesOf(close), test::BytesOf(posts.Plan(near, NoCheckpoints())));

  // From where it was told of: whatever it stood in the way of is free now.
  const PlannedJob away = posts.Plan(Box(-3000, 0, 50), kept);
  EXPECT_EQ(away.resumed_passes, 0);
  EXPECT_EQ(test::BytesOf(away), test::BytesOf(first));
}

TEST(KeptPass, AnotherShapeIsAChange) {
  Posts posts;
  const test::MemoryCheckpoints kept;
  posts.Plan(Box(-3000, 0, 50), kept);
  EXPECT_EQ(posts.Plan(Box(-3000, 0, 50, 120), kept).resumed_passes, 2);
  EXPECT_EQ(posts.Plan(Box(-3000, 0, 50, 8000), kept).resumed_passes, 0);
}

TEST(KeptPass, ObstaclesAreWhatStandsStillAndIsNoPart) {
  const PlannedJob& job = test::FreshPlan();
  const Obstacles obstacles = ObstaclesOf(job.prepared.cell);
  ASSERT_EQ(obstacles.size(), 1);
  EXPECT_EQ(obstacles.begin()->first, "platform");
}

}  // namespace
}  // namespace millpose
