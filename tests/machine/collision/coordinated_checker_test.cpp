// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/coordinated_checker.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/machine/collision/sample_cell.hpp"
#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace {

using test::At;

/// A ball on the flange, balls on the part and in the world, a post on the rail's carriage.
Cell Balls(RandomStream& random) {
  Cell cell;
  cell.arm = Kr500R2830();
  cell.external_axes.resize(2);
  cell.external_axes[0].direction = Eigen::Vector3d(0.6, 0.8, 0);
  cell.external_axes[1].kind = AxisKind::kRotary;
  cell.external_axes[1].carries = Carries::kWorkpiece;
  cell.external_axes[1].direction = Eigen::Vector3d::UnitZ();
  cell.external_axes[1].origin = {2000, 0, 0};
  cell.clearances.free = 10;
  cell.X_FT = At(0, 0, 200);
  Joints middle = Joints::Zero();
  middle[1] = -1.3, middle[2] = 1.3;
  const Eigen::Vector3d tool = (ForwardFlange(cell.arm, middle) * cell.X_FT).translation();
  const auto place = [&] {
    return At(tool.x() + random.Uniform(-400, 400), tool.y() + random.Uniform(-400, 400),
              tool.z() + random.Uniform(-400, 400));
  };
  cell.bodies = {{"ball", BodyClass::kSpindle, Mount::kTool, 0, Pose::Identity(), Sphere{90}},
                 {"part", BodyClass::kFixture, Mount::kWorkpiece, 0, place(), Sphere{120}},
                 {"post", BodyClass::kFixture, Mount::kWorld, 0, place(), Capsule{60, 500}},
                 {"cabinet", BodyClass::kFixture, Mount::kCarriage, 0, place(), Box{{150, 120, 300}}, 0}};
  return cell;
}

ExternalPosition Between(const ExternalPosition& a, const ExternalPosition& b, double share) {
  ExternalPosition position = a;
  for (size_t i = 0; i < a.size(); ++i) position[i] += share * (b[i] - a[i]);
  return position;
}

/// The smallest distance on the motion at positions close together, joints `beside` those of the motion.
double Nearest(const World& world, const CoordinatedPose& from, const CoordinatedPose& to,
               const Joints& beside) {
  constexpr int kSteps = 400;
  double nearest = 50;
  for (int k = 0; k <= kSteps; ++k) {
    const double share = static_cast<double>(k) / kSteps;
    Checker checker(world.At(Between(from.external, to.external, share)));
    nearest = std::min(nearest,
                       checker.Clearance(from.q + share * (to.q - from.q) + beside, Phase::kFree, nearest));
  }
  return nearest;
}

TEST(CoordinatedChecker, FindsWhatLookingDenselyFindsAndNothingElse) {
  constexpr double kResolution = 0.5;
  RandomStream random(5, 0);
  int blocked = 0, free = 0, near = 0;
  for (int k = 0; k < 500; ++k) {
    const World world(Balls(random));
    CoordinatedPose from, to;
    for (int j = 0; j < 6; ++j) {
      from.q[j] = random.Uniform(-0.5, 0.5) + (j == 1 ? -1.3 : j == 2 ? 1.3 : 0);
      to.q[j] = from.q[j] + random.Uniform(-0.15, 0.15);
    }
    from.external = {random.Uniform(-300, 300), random.Uniform(-0.5, 0.5)};
    to.external = {from.external[0] + random.Uniform(-300, 300),
                   from.external[1] + random.Uniform(-0.4, 0.4)};
    CoordinatedChecker checker(world);
    const auto found = checker.BlockedBetween(from, to, Phase::kFree, kResolution);
    const double nearest = Nearest(world, from, to, Joints::Zero());
    if (!found) {
      EXPECT_GE(nearest, 10 - kResolution) << k;
      ++free;
      near += nearest < 20;
    } else {
      // A blocked answer is true as well: dense looking may miss it by what lies between two of its looks.
      EXPECT_LT(nearest, 10 + 1.5) << k;
      const World there = world.At(found->external);
      EXPECT_LT(Checker(there).Measure(found->sighting).distance, 10 + 1e-9) << k;
      ++blocked;
    }
  }
  EXPECT_GT(blocked, 20);
  EXPECT_GT(free, 20);
  EXPECT_GT(near, 1);
}

TEST(CoordinatedChecker, AnswersAsACheckerWhereTheAxesStand) {
  RandomStream random(6, 0);
  int blocked = 0;
  for (int k = 0; k < 200; ++k) {
    const World world(Balls(random));
    CoordinatedPose from, to;
    for (int j = 0; j < 6; ++j) {
      from.q[j] = random.Uniform(-0.5, 0.5) + (j == 1 ? -1.3 : j == 2 ? 1.3 : 0);
      to.q[j] = from.q[j] + random.Uniform(-0.3, 0.3);
    }
    from.external = to.external = {random.Uniform(-300, 300), random.Uniform(-0.5, 0.5)};
    const bool found = CoordinatedChecker(world).BlockedBetween(from, to, Phase::kFree, 0.5).has_value();
    const double nearest = Nearest(world, from, to, Joints::Zero());
    if (nearest < 9.5) {
      EXPECT_TRUE(found) << k;
    }
    if (nearest > 11) {
      EXPECT_FALSE(found) << k;
    }
    blocked += found;
  }
  EXPECT_GT(blocked, 10);
}

TEST(CoordinatedChecker, MotionsBesideItAreFreeToo) {
  RandomStream random(7, 0);
  int free = 0;
  const Joints tube = Joints::Constant(2e-5);
  for (int k = 0; k < 60; ++k) {
    const World world(Balls(random));
    CoordinatedPose from, to;
    for (int j = 0; j < 6; ++j) {
      from.q[j] = random.Uniform(-0.5, 0.5) + (j == 1 ? -1.3 : j == 2 ? 1.3 : 0);
      to.q[j] = from.q[j] + random.Uniform(-0.1, 0.1);
    }
    from.external = {random.Uniform(-300, 300), random.Uniform(-0.5, 0.5)};
    to.external = {from.external[0] + random.Uniform(-100, 100), from.external[1]};
    if (CoordinatedChecker(world).BlockedBetween(from, to, Phase::kFree, 0.5, tube)) continue;
    EXPECT_GE(Nearest(world, from, to, tube), 9.5);
    EXPECT_GE(Nearest(world, from, to, -tube), 9.5);
    ++free;
  }
  EXPECT_GT(free, 20);
}

TEST(World, CopiesElsewhereHaveTheWholeCell) {
  RandomStream random(8, 0);
  Cell cell = Balls(random);
  Triangles tetrahedron{{{0, 0, 0}, {50, 0, 0}, {0, 50, 0}, {0, 0, 50}},
                        {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  cell.bodies.push_back({"mesh", BodyClass::kWorkpiece, Mount::kWorkpiece, 0, At(0, 0, 0), tetrahedron});
  const World world(cell), moved = world.At({100, 0.3}), twice = moved.With(At(1, 2, 3), At(4, 5, 6));
  for (const World* of : {&world, &moved, &twice})
    EXPECT_EQ(std::get<Triangles>(of->cell().bodies.back().shape).vertices.size(), 4u);
  EXPECT_EQ(moved.cell().external, (ExternalPosition{100, 0.3}));
  EXPECT_EQ(twice.cell().X_WB.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(world.cell().external, ExternalPosition());
}

}  // namespace
}  // namespace millpose
