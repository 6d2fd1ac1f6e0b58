// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/query_log.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "machine/collision/point_memory.hpp"
#include "machine/collision/world.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose {
namespace {

Cell WithPost(const Eigen::Vector3d& at) {
  Cell cell = test::SampleCell();
  cell.X_WP = test::At(1900, 0, 1100);
  cell.bodies.push_back({"workpiece", BodyClass::kWorkpiece, Mount::kWorkpiece, 0, Pose::Identity(),
                         test::BoxMesh({250, 700, 120})});
  cell.bodies.push_back(
      {"post", BodyClass::kFixture, Mount::kWorld, 0, test::At(at.x(), at.y(), at.z()), Box{{80, 60, 300}}});
  return cell;
}

std::string Text(const Checker& checker, const std::optional<ContactCandidate>& found) {
  if (!found) return fmt::format("free {};", checker.counts().poses);
  return fmt::format("{} at {} {} {};", found->pair, found->q[0], found->q[4], found->bound);
}

/// All that some questions about poses near one another are answered with, counts and all.
std::string Ask(const World& world, uint64_t stream) {
  RandomStream random(5, stream);
  Joints start = test::Degrees(0, -60, 90, 0, 60, 0);
  for (int i = 0; i < 6; ++i) start[i] += random.Uniform(-0.3, 0.3);
  Checker checker(world), narrow(world, 0.5);
  PointMemory memory;
  std::string answers;
  for (int i = 0; i < 4; ++i) {
    Joints q = start, q1 = start, tube;
    for (int k = 0; k < 6; ++k) {
      q[k] += random.Uniform(-0.01, 0.01);
      q1[k] = q[k] + random.Uniform(-0.06, 0.06);
      tube[k] = random.Uniform(0, 1e-3);
    }
    const Phase phase = i % 2 == 0 ? Phase::kFree : Phase::kCutting;
    answers += Text(checker, checker.Blocked(q, phase));
    answers += Text(checker, checker.Blocked(q1, phase, {0.1 * i}, memory));
    answers += Text(checker, checker.BlockedBetween(q, q1, phase, 0.5, tube));
    answers += Text(narrow, narrow.BlockedBetween(q, q1, phase));
    const auto nearest = checker.Nearest(q1, phase, 60);
    answers +=
        nearest ? fmt::format("{} {} {};", nearest->first, nearest->second, nearest->distance) : "far;";
  }
  const CheckCounts& counts = checker.counts();
  return answers + fmt::format("{} {} {}", counts.poses, counts.pairs, counts.pairs_saved);
}

TEST(Queries, WhatIsFarFromThemChangesNoAnswer) {
  RandomStream random(6, 0);
  int same = 0, told = 0, changed = 0;
  for (uint64_t round = 0; round < 400; ++round) {
    const Eigen::Vector3d before(random.Uniform(900, 2500), random.Uniform(-900, 900),
                                 random.Uniform(300, 1900));
    const Eigen::Vector3d after = before + 400 * Eigen::Vector3d(random.Normal(), random.Normal(), 0);
    const auto keeper = std::make_shared<QueryLog>();
    const World old(WithPost(before)), now(WithPost(after));
    const std::string answers = Ask(old.Recording(keeper), round);
    EXPECT_EQ(answers, Ask(old, round));  // being watched changes nothing
    const Queries looks = keeper->Collected();
    ASSERT_FALSE(looks.boxes.empty());
    const bool met = std::find(looks.met.begin(), looks.met.end(), "post") != looks.met.end();
    const bool differs = Ask(now, round) != answers;
    told += met;
    changed += differs;
    if (met || !now.FarFrom({"post"}, looks)) continue;
    ++same;
    EXPECT_FALSE(differs) << round;
  }
  EXPECT_GT(same, 100);
  EXPECT_GT(told, 20);
  EXPECT_GT(changed, 40);
}

/// Motions alone, with wide tubes about them.
std::string AskInTubes(const World& world, uint64_t stream) {
  RandomStream random(11, stream);
  Checker checker(world);
  std::string answers;
  for (int i = 0; i < 4; ++i) {
    Joints q0 = test::Degrees(0, -75, 75, 0, 60, 0), q1, tube;
    for (int k = 0; k < 6; ++k) {
      q0[k] += random.Uniform(-0.1, 0.1);
      q1[k] = q0[k] + random.Uniform(-0.01, 0.01);
      tube[k] = random.Uniform(0, 4e-3);
    }
    answers += Text(checker, checker.BlockedBetween(q0, q1, Phase::kFree, 0.5, tube));
  }
  return answers;
}

// A post that comes in from afar, from the front, a side or above: where the record still lets it stand, no
// answer is another.
void ExpectToHoldNear(const std::function<std::string(const World&, uint64_t)>& ask, double within) {
  RandomStream random(9, 0);
  int changed = 0;
  for (uint64_t round = 0; round < 150; ++round) {
    const Eigen::Vector3d towards(random.Uniform(900, 2300), random.Uniform(-500, 500),
                                  random.Uniform(900, 1700));
    const Eigen::Vector3d from =
        Eigen::Vector3d::Unit(round % 3) * (round % 2 == 0 || round % 3 != 1 ? 1 : -1);
    const auto world = [&](double away) { return World(WithPost(towards + away * from)); };
    const auto keeper = std::make_shared<QueryLog>();
    const std::string answers = ask(world(5000).Recording(keeper), round);
    const Queries looks = keeper->Collected();
    double far = 5000, near = 0;
    while (far - near > 0.5) {
      const double middle = 0.5 * (far + near);
      (world(middle).FarFrom({"post"}, looks) ? far : near) = middle;
    }
    EXPECT_EQ(ask(world(far), round), answers) << round << " at " << far;
    changed += ask(world(far - within), round) != answers;
  }
  EXPECT_GT(changed, 25) << "little is given away";
}

TEST(Queries, HoldToTheNearestPlaceThatTheyAllow) { ExpectToHoldNear(Ask, 60); }

TEST(Queries, LeaveRoomForTubes) { ExpectToHoldNear(AskInTubes, 150); }

/// What long ways are answered with, from one side of the part to the other.
std::string AskLong(const World& world, uint64_t stream) {
  RandomStream random(7, stream);
  Checker checker(world);
  std::string answers;
  for (int i = 0; i < 3; ++i) {
    Joints from = test::Degrees(-40, -80, 90, 0, 60, 0), to = test::Degrees(40, -80, 90, 0, 60, 0);
    for (int k = 0; k < 6; ++k) from[k] += random.Uniform(-0.2, 0.2), to[k] += random.Uniform(-0.2, 0.2);
    answers += Text(checker, checker.BlockedBetween(from, to, Phase::kFree));
    answers += Text(checker, checker.BlockedBetween(to, from, Phase::kFree, 0.5, Joints::Constant(1e-4)));
  }
  return answers;
}

TEST(Queries, ALongWayIsKnownByWhereItLeadsAndNotByAllBetweenItsEnds) {
  RandomStream random(8, 0);
  int same = 0, changed = 0;
  for (uint64_t round = 0; round < 200; ++round) {
    const Eigen::Vector3d before(-1500, 1500, 200),
        after(random.Uniform(500, 3000), random.Uniform(-2000, 2000), random.Uniform(200, 2200));
    const auto keeper = std::make_shared<QueryLog>();
    const World old(WithPost(before)), now(WithPost(after));
    const std::string answers = AskLong(old.Recording(keeper), round);
    const bool far = now.FarFrom({"post"}, keeper->Collected());
    const bool differs = AskLong(now, round) != answers;
    same += far;
    changed += differs;
    EXPECT_FALSE(far && differs) << round;
  }
  EXPECT_GT(same, 20);
  EXPECT_GT(changed, 30);
}

TEST(Queries, BoxesHoldWhatWasAskedAndLittleMore) {
  RandomStream random(9, 0);
  for (int round = 0; round < 300; ++round) {
    QueryLog log;
    Joints low, high, other_low, other_high;
    for (int i = 0; i < 6; ++i) {
      low[i] = random.Uniform(-12, 12);
      high[i] = low[i] + random.Uniform(0, 0.004);
      other_low[i] = low[i] + random.Uniform(-1e-5, 1e-5);
      other_high[i] = high[i] + random.Uniform(-1e-5, 1e-5);
    }
    const double reach = random.Uniform(0, 90), other_reach = reach + random.Uniform(-0.1, 0.1);
    log.Add(low, high, reach);
    log.Add(other_low, other_high, other_reach);
    const std::vector<PoseBox> boxes = log.Collected().boxes;
    if (boxes.size() != 1) continue;  // the two lie beside each other
    const PoseBox& box = boxes.front();
    for (int i = 0; i < 6; ++i) {
      const auto k = static_cast<size_t>(i);
      const double begin = kBoxAngle * box.low[k], end = kBoxAngle * (box.low[k] + box.width[k]);
      EXPECT_LE(begin, std::min(low[i], other_low[i]));
      EXPECT_GE(end, std::max(high[i], other_high[i]));
      EXPECT_LE(end - begin,
                std::max(high[i], other_high[i]) - std::min(low[i], other_low[i]) + 2 * kBoxAngle);
    }
    EXPECT_GE(kBoxLength * box.reach, std::max(reach, other_reach));
    EXPECT_LE(kBoxLength * box.reach, std::max(reach, other_reach) + kBoxLength);
  }
}

TEST(Queries, SeveralCheckersAreKeptTogether) {
  const World world(WithPost({1500, 400, 1000}));
  const auto keeper = std::make_shared<QueryLog>();
  const Joints q = test::HomePose();
  for (int i = 0; i < 3; ++i) {
    Checker checker(world.Recording(keeper));
    Joints turned = q;
    turned[0] += 0.5 * i;
    checker.Blocked(turned, Phase::kFree);
    checker.Blocked(turned, Phase::kFree);
  }
  EXPECT_EQ(keeper->Collected().boxes.size(), 3);
}

}  // namespace
}  // namespace millpose
