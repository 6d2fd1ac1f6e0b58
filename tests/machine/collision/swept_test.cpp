// SPDX-License-Identifier: GPL-3.0-or-later
// Checker::Between keeps its promise: what it calls free is free at every sample of a dense walk.
#include "machine/collision/world.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/base/tier.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

/// The smallest clearance on a walk of `steps` steps.
double Walk(const World& world, const Joints& q0, const Joints& q1, Phase phase, int steps, double bound) {
  Checker checker(world);
  double smallest = bound;
  for (int i = 0; i <= steps; ++i) {
    smallest = std::min(smallest, checker.Clearance(q0 + (q1 - q0) * i / steps, phase, bound));
  }
  return smallest;
}

/// A thin sheet beside the tool, as a mesh (`solid`: closed) or a box.
Cell SheetCell(const Joints& at, const Pose& X_TS, int kind) {
  Cell cell = SampleCell();
  cell.clearances = {1, 1};
  const Eigen::Vector3d size(400, 400, 0.5);
  Shape shape = Box{size};
  if (kind == 1) shape = BoxMesh(size);
  if (kind == 2) {
    Triangles sheet;
    sheet.vertices = {{-200, -200, 0}, {200, -200, 0}, {200, 200, 0}, {-200, 200, 0}};
    sheet.faces = {{0, 1, 2}, {0, 2, 3}};
    shape = sheet;
  }
  const Pose X_WT = ForwardFlange(cell.arm, at) * cell.X_FT;
  cell.bodies.push_back({"sheet", BodyClass::kFixture, Mount::kWorld, 0, X_WT * X_TS, shape});
  return cell;
}

TEST(Between, MissesNoInterferenceAtAThinSheet) {
  const Joints middle = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);
  RandomStream random(17, 0);
  int free = 0, blocked = 0;
  const int sheets = OfTier(9, 400);
  for (int sheet = 0; sheet < sheets; ++sheet) {
    const World world(SheetCell(middle, At(0, 0, 100) * RandomPose(random, 120), sheet % 3));
    for (int trial = 0; trial < 25; ++trial) {
      Joints q0 = middle, q1 = middle;
      for (int i = 0; i < 6; ++i) {
        q0[i] += random.Uniform(-0.06, 0.06);
        q1[i] += random.Uniform(-0.06, 0.06);
      }
      const auto found = Checker(world).Between(q0, q1, Phase::kFree, 0.5);
      const double truth = Walk(world, q0, q1, Phase::kFree, 200, 5);
      if (found) {
        EXPECT_LT(truth, 1.0 + 0.5) << "blocked though the walk is free";
        ++blocked;
      } else {
        EXPECT_GE(truth, 0.5 - 1e-9) << "called free, yet nearer than clearance less resolution";
        ++free;
      }
    }
  }
  EXPECT_GT(free, sheets / 3);
  EXPECT_GT(blocked, 3 * sheets);
}

TEST(Between, PassingThroughASheetIsFoundThoughBothEndsAreFree) {
  const Joints middle = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);
  for (int kind = 0; kind < 3; ++kind) {
    // A1 carries the tip, 2 m from its axis, by ±80 mm through the sheet.
    Pose X_TS = At(0, 0, 30);
    X_TS.linear() = (ForwardFlange(SampleArm(), middle) * EmptyCell().X_FT).linear().transpose() *
                    Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
    Cell cell = SheetCell(middle, X_TS, kind);
    cell.bodies.back().shape = kind == 1 ? Shape(BoxMesh({60, 60, 0.5})) : cell.bodies.back().shape;
    if (kind == 0) cell.bodies.back().shape = Box{{60, 60, 0.5}};
    if (kind == 2) {
      for (auto& v : std::get<Triangles>(cell.bodies.back().shape).vertices) v *= 0.15;
    }
    const World world(cell);
    Joints q0 = middle, q1 = middle;
    q0[0] -= 0.04;
    q1[0] += 0.04;
    Checker checker(world);
    ASSERT_FALSE(checker.At(q0, Phase::kFree)) << kind;
    ASSERT_FALSE(checker.At(q1, Phase::kFree)) << kind;
    const auto found = checker.Between(q0, q1, Phase::kFree, 0.5);
    ASSERT_TRUE(found) << kind;
    EXPECT_EQ(found->first, "sheet");
  }
}

TEST(Between, LongMotionsThroughTheWholeCell) {
  const World world(SampleCell());
  RandomStream random(19, 0);
  int free = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const Joints q0 = RandomJoints(random, world.cell().arm), q1 = RandomJoints(random, world.cell().arm);
    if (!Checker(world).Between(q0, q1, Phase::kFree, 1.0)) {
      EXPECT_GE(Walk(world, q0, q1, Phase::kFree, 300, 50), 9.0 - 1e-9);
      ++free;
    }
  }
  EXPECT_GT(free, 3);
}

TEST(Between, SettlesAFreeMotionWithFewLooks) {
  const World world(SampleCell());
  Checker checker(world);
  const Joints q = HomePose();
  EXPECT_FALSE(checker.Between(q, q + Joints::Constant(0.01), Phase::kFree, 0.5));
  EXPECT_LE(checker.poses_checked(), 3);
  // A motion that does not move still looks once.
  EXPECT_FALSE(checker.Between(q, q, Phase::kFree, 0.5));
}

}  // namespace
}  // namespace millpose::test
