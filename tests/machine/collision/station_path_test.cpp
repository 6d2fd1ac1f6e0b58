// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/station_path.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"
#include "base/units.hpp"
#include "tests/machine/collision/sample_cell.hpp"
#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace {

using test::At;

/// A ball on the part's table, one on a rail's carriage, one on the arm's base, one in the world.
Cell FourBalls(const std::vector<ExternalAxis>& axes, RandomStream& random) {
  Cell cell;
  cell.arm = Kr500R2830();
  cell.external_axes = axes;
  cell.clearances.free = 10;
  const auto place = [&] {
    return At(random.Uniform(-600, 600), random.Uniform(-600, 600), random.Uniform(-600, 600));
  };
  cell.bodies = {{"part", BodyClass::kFixture, Mount::kWorkpiece, 0, place(), Sphere{80}},
                 {"carriage", BodyClass::kFixture, Mount::kCarriage, 0, place(), Sphere{60}, 0},
                 {"base", BodyClass::kLink, Mount::kLink, 0, place(), Box{{90, 70, 110}}},
                 {"post", BodyClass::kFixture, Mount::kWorld, 0, place(), Capsule{40, 300}}};
  return cell;
}

std::vector<ExternalAxis> RailTiltTurn() {
  std::vector<ExternalAxis> axes(3);
  axes[0].carries = Carries::kRobot;
  axes[0].direction = Eigen::Vector3d(0.6, 0.8, 0);
  for (const size_t i : {size_t{1}, size_t{2}}) {
    axes[i].kind = AxisKind::kRotary;
    axes[i].carries = Carries::kWorkpiece;
  }
  axes[1].direction = Eigen::Vector3d::UnitY();
  axes[1].origin = {50, 0, -100};
  axes[2].direction = Eigen::Vector3d::UnitZ();
  axes[2].origin = {20, 30, 0};
  return axes;
}

/// Whether anything comes nearer than `clearance` at positions close together.
bool MeetsDensely(Cell cell, double clearance, const ExternalPosition& from, const ExternalPosition& to) {
  constexpr int kSteps = 1000;
  cell.clearances.free = clearance;
  const StationPath way(World(cell), Joints::Zero(), 0.5);
  for (int k = 0; k <= kSteps; ++k) {
    ExternalPosition at = from;
    for (size_t i = 0; i < at.size(); ++i) at[i] += (to[i] - from[i]) * k / kSteps;
    if (way.At(at)) return true;
  }
  return false;
}

TEST(StationPath, FindsWhatLookingDenselyFindsAndNothingElse) {
  RandomStream random(1, 0);
  int blocked = 0, free = 0;
  for (int k = 0; k < 40; ++k) {
    const Cell cell = FourBalls(RailTiltTurn(), random);
    const auto position = [&] {
      return ExternalPosition{random.Uniform(-500, 500), random.Uniform(-1, 1), random.Uniform(-3, 3)};
    };
    const ExternalPosition from = position(), to = position();
    const auto found = StationPath(World(cell), Joints::Zero(), 0.5).Between(from, to);
    if (MeetsDensely(cell, 9, from, to)) {
      EXPECT_TRUE(found) << k;
      ++blocked;
    } else if (!MeetsDensely(cell, 12, from, to)) {
      EXPECT_FALSE(found) << k << ": " << found->first << " " << found->second;
      ++free;
    }
    if (found) {
      EXPECT_LT(found->distance, 10);
    }
  }
  EXPECT_GT(blocked, 5);
  EXPECT_GT(free, 5);
}

TEST(StationPath, LeavesOutWhatIsJoinedAndWhatIsExcluded) {
  std::vector<ExternalAxis> axes = RailTiltTurn();
  axes[0].direction = Eigen::Vector3d::UnitX();
  Cell cell;
  cell.arm = Kr500R2830();
  cell.external_axes = axes;
  cell.bodies = {{"cradle", BodyClass::kFixture, Mount::kCarriage, 0, At(0, 0, 0), Sphere{80}, 1},
                 {"table", BodyClass::kFixture, Mount::kCarriage, 0, At(0, 0, 50), Sphere{80}, 2},
                 {"carriage", BodyClass::kFixture, Mount::kCarriage, 0, At(2000, 0, 0), Sphere{80}, 0},
                 {"bed", BodyClass::kFixture, Mount::kWorld, 0, At(2000, 0, -100), Sphere{80}}};
  const auto touching = [&] { return StationPath(World(cell), Joints::Zero(), 0.5).At({0, 0, 0}); };
  ASSERT_TRUE(touching());
  EXPECT_EQ(touching()->first + touching()->second, "carriagebed");
  cell.excluded_pairs = {{"bed", "carriage"}};
  EXPECT_FALSE(touching());
  // What lies on the table is no joint: it may not meet what the table turns in.
  cell.bodies.push_back({"part", BodyClass::kFixture, Mount::kWorkpiece, 0, At(0, 0, -60), Sphere{30}});
  ASSERT_TRUE(touching());
  EXPECT_EQ(touching()->first, "cradle");
}

TEST(World, AtMovesEverythingWithItsAxis) {
  RandomStream random(2, 0);
  const std::vector<ExternalAxis> axes = RailTiltTurn();
  const World zero(FourBalls(axes, random));
  const ExternalPosition position{300, 0.4, -2};
  const World moved = zero.At(position);
  const Mechanism mechanism(axes);
  EXPECT_LT((moved.cell().X_WB.translation() - Eigen::Vector3d(180, 240, 0)).norm(), 1e-9);
  EXPECT_LT((moved.cell().X_WP.matrix() - mechanism.Moved(Carries::kWorkpiece, position).matrix()).norm(),
            1e-12);
  EXPECT_EQ(moved.cell().external, position);
}

}  // namespace
}  // namespace millpose
