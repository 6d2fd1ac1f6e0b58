// SPDX-License-Identifier: GPL-3.0-or-later
// What checkers try before they ask FCL for a distance changes no answer: not whether a pose or a motion is
// free, not which pair is found nor where.
#include "machine/collision/world.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/base/tier.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

/// A block as a mesh, a box and a round post about the tool at a milling pose: shapes of every kind near
/// others.
Cell NarrowCell(const Joints& at) {
  Cell cell = SampleCell();
  cell.clearances = {8, 4};
  const Pose X_WT = LinkFrames(cell.arm, at)[6] * cell.X_FT;
  const auto add = [&](const char* name, const Pose& X_TG, Shape shape) {
    cell.bodies.push_back({name, BodyClass::kFixture, Mount::kWorld, 0, X_WT * X_TG, std::move(shape)});
  };
  add("block", At(0, 0, -70), BoxMesh({400, 300, 100}));
  add("clamp", At(150, 0, 20), Box{{60, 60, 60}});
  add("post", At(0, 190, 200), Cylinder{40, 400});
  return cell;
}

Joints Near(RandomStream& random, const Joints& q, double by) {
  Joints near = q;
  for (int i = 0; i < 6; ++i) near[i] += random.Uniform(-by, by);
  return near;
}

void ExpectSame(const std::optional<ContactCandidate>& a, const std::optional<ContactCandidate>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_EQ(a->pair, b->pair);
  EXPECT_EQ(a->q, b->q);
  EXPECT_EQ(a->bound, b->bound);
}

TEST(Shortcuts, ChangeNoAnswerOfAChecker) {
  const Joints middle = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);
  const World world(NarrowCell(middle)), measuring = world.MeasuringAll();
  Checker fast(world), slow(measuring);
  RandomStream random(31, 0);
  int free = 0, blocked = 0, halved = 0;
  const int trials = OfTier(300, 3000);
  for (int trial = 0; trial < trials; ++trial) {
    const Phase phase = trial % 2 ? Phase::kFree : Phase::kCutting;
    const Joints q0 = Near(random, middle, 0.1), q1 = Near(random, q0, 0.03);
    ExpectSame(fast.Blocked(q0, phase), slow.Blocked(q0, phase));
    const Joints tube = Joints::Constant(trial % 3 ? 0 : 1e-5);
    const long long before = fast.counts().looks, slow_before = slow.counts().looks;
    const auto found = fast.BlockedBetween(q0, q1, phase, 0.5, tube);
    ExpectSame(found, slow.BlockedBetween(q0, q1, phase, 0.5, tube));
    EXPECT_EQ(fast.counts().looks - before, slow.counts().looks - slow_before) << "cut up alike";
    halved += fast.counts().looks - before > 3;
    ++(found ? blocked : free);
    const auto near = fast.Nearest(q0, phase, 50), measured = slow.Nearest(q0, phase, 50);
    ASSERT_EQ(near.has_value(), measured.has_value());
    if (!near) continue;
    EXPECT_EQ(near->first, measured->first);
    EXPECT_EQ(near->second, measured->second);
    EXPECT_NEAR(near->distance, measured->distance, 1e-6);
  }
  EXPECT_GT(free, trials / 10);
  EXPECT_GT(blocked, trials / 10);
  EXPECT_GT(halved, trials / 10);
}

TEST(Shortcuts, ALineIsAnsweredAsItsMotionsOneByOne) {
  const Joints middle = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);
  const World world(NarrowCell(middle));
  Checker fast(world), slow(world.MeasuringAll()), single(world);
  RandomStream random(37, 0);
  int free = 0, later = 0;
  const int trials = OfTier(150, 3000);
  for (int trial = 0; trial < trials; ++trial) {
    const Phase phase = trial % 2 ? Phase::kFree : Phase::kCutting;
    std::vector<Joints> line{Near(random, middle, 0.1)};
    const Joints by = Near(random, Joints::Zero(), 0.01);
    while (line.size() < static_cast<size_t>(2 + trial % 12))
      line.push_back(line.back() + by + Near(random, Joints::Zero(), 0.002));
    const long long before = fast.poses_checked();
    const auto found = fast.BlockedAlong(line, phase, 0.5);
    ExpectSame(found, slow.BlockedAlong(line, phase, 0.5));
    std::optional<ContactCandidate> one;
    size_t asked = 0;
    while (!one && asked + 1 < line.size()) {
      one = single.BlockedBetween(line[asked], line[asked + 1], phase, 0.5);
      ++asked;
    }
    ExpectSame(found, one);
    EXPECT_EQ(fast.poses_checked() - before, static_cast<long long>(asked));
    free += !found;
    later += found && asked > 1;
  }
  EXPECT_GT(free, trials / 10);
  EXPECT_GT(later, trials / 20);
}

}  // namespace
}  // namespace millpose::test
