// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/cached_pass.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"
#include "base/units.hpp"
#include "base/value_bytes.hpp"
#include "machine/robot/kinematics.hpp"
#include "run/pipeline/stages/compare_fixed.hpp"
#include "run/pipeline/stages/plan_passes.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose {
namespace {

/// The small job in a cell with a post.
class Posts {
 public:
  Posts() : folder_("posts") { test::CopySmallJob(folder_); }

  JobInputs Inputs(const std::string& post, const std::vector<Override>& overrides = {}) {
    folder_.Write("cell.yaml", ReadFile(test::SamplePath("cells/kr500_r2830.yaml")));
    folder_.Change(
        "cell.yaml", "excluded_pairs: []",
        fmt::format("  - {{name: post, class: fixture, mount: world, {}}}\nexcluded_pairs: []", post));
    return LoadJobInputs(folder_.path() / "job.yaml", overrides);
  }
  PlannedJob Plan(const std::string& post, const CheckpointStore& checkpoints,
                  const std::vector<Override>& overrides = {}) {
    return PlanJob(Inputs(post, overrides), checkpoints, {.threads = 1});
  }

 private:
  test::TestFolder folder_;
};

std::string BoxStl(double x, double y, double z, double size = 100) {
  return fmt::format("shape: {{box: {{size_mm: [{0}, {0}, {0}]}}}}, pose: {{xyz_mm: [{1}, {2}, {3}]}}", size,
                     x, y, z);
}

TEST(KeptPass, AMovedFixtureCostsOnlyThePassesItMatters) {
  Posts posts;
  const test::MemoryCheckpoints kept;
  const PlannedJob first = posts.Plan(BoxStl(-3000, 0, 50), kept);
  ASSERT_EQ(first.resumed_passes, 0);
  const size_t passes = first.plan.passes.size();

  const PlannedJob far = posts.Plan(BoxStl(-3000, 1500, 50), kept);
  EXPECT_EQ(far.resumed_passes, passes);
  EXPECT_EQ(far.resumed_gaps, far.plan.gaps.size());
  EXPECT_EQ(test::BytesOf(far), test::BytesOf(posts.Plan(BoxStl(-3000, 1500, 50), NoCheckpoints())));

  const Eigen::Vector3d tip = first.plan.passes[0].points[0].point.position;
  const std::string near = BoxStl(tip.x() - 150, tip.y(), tip.z() + 260);
  const PlannedJob close = posts.Plan(near, kept);
  EXPECT_EQ(close.resumed_passes, 0);
  EXPECT_EQ(test::BytesOf(close), test::BytesOf(posts.Plan(near, NoCheckpoints())));

  // What was planned before it came is found again, and what was planned with it as well.
  const PlannedJob away = posts.Plan(BoxStl(-3000, 0, 50), kept);
  EXPECT_EQ(away.resumed_passes, passes);
  EXPECT_EQ(away.resumed_gaps, away.plan.gaps.size());
  EXPECT_EQ(test::BytesOf(away), test::BytesOf(first));
  const PlannedJob back = posts.Plan(near, kept);
  EXPECT_EQ(back.resumed_passes, passes);
  EXPECT_EQ(test::BytesOf(back), test::BytesOf(close));

  // From where it was told of: whatever it stood in the way of is free now.
  const test::MemoryCheckpoints of_near;
  posts.Plan(near, of_near);
  const PlannedJob anew = posts.Plan(BoxStl(-3000, 0, 50), of_near);
  EXPECT_EQ(anew.resumed_passes, 0);
  EXPECT_EQ(test::BytesOf(anew), test::BytesOf(first));
}

// A stage that is made again takes note of where the post stands.
TEST(KeptPass, WhatFollowsFromAllPassesIsKeptAsWell) {
  Posts posts;
  const test::MemoryCheckpoints kept;
  const PlannedJob first = posts.Plan(BoxStl(-3000, 0, 50), kept);
  const auto before = kept.stages;
  const std::string far = BoxStl(-3000, 1500, 50);
  const PlannedJob again = posts.Plan(far, kept);
  for (const std::string stage : {"ends", "fixed-0", "programs-linuxcnc"})
    EXPECT_EQ(kept.stages.at(stage), before.at(stage)) << stage;
  EXPECT_EQ(test::BytesOf(again), test::BytesOf(posts.Plan(far, NoCheckpoints())));
  EXPECT_NE(again.programs.programs[0].files, first.programs.programs[0].files) << "the inputs have a name";
  EXPECT_EQ(again.programs.programs[0].files.begin()->second.size(),
            first.programs.programs[0].files.begin()->second.size());
}

// The verification of a program asks about poses in a dry run alone, the others are proven by the plan: a
// post is brought nearer until it may matter to that, but to no pass.
TEST(KeptPass, AProgramIsVerifiedAgainWhereAMovedFixtureMayMatterToIt) {
  Posts posts;
  std::string near;
  for (const bool dry : {true, false}) {
    const std::vector<Override> overrides{{"program_options.dry_run_offset_mm", dry ? "100" : "0"}};
    const test::MemoryCheckpoints kept;
    const PlannedJob first = posts.Plan(BoxStl(-3000, 0, 50), kept, overrides);
    const auto before = kept.stages.at("programs-linuxcnc");
    const auto is_made_again = [&] {
      const PlannedJob again = posts.Plan(near, kept, overrides);
      for (size_t p = 0; p < first.plan.passes.size(); ++p)
        EXPECT_TRUE(HashOfValues(again.plan.passes[p]) == HashOfValues(first.plan.passes[p]))
            << "it is in no way";
      return kept.stages.at("programs-linuxcnc") != before;
    };
    if (!dry) {
      EXPECT_FALSE(is_made_again());
      continue;
    }
    const Joints& q = first.plan.passes[0].points[0].q;
    const Eigen::Vector3d flange = (first.plan.X_WB * ForwardFlange(first.plan.arm, q)).translation();
    double beside = 700;
    do {
      beside -= 50;
      near = BoxStl(flange.x() - 300, flange.y() - beside, flange.z(), 20);
    } while (!is_made_again() && beside > 0);
    EXPECT_GT(beside, 250);
    EXPECT_TRUE(test::BytesOf(posts.Plan(near, kept, overrides)) ==
                test::BytesOf(posts.Plan(near, NoCheckpoints(), overrides)));
  }
}

// Fixed rotations swing where the plan does not. What was asked about a pass alone, and what more beside
// another, counts together.
TEST(KeptPass, WhatFixedRotationsMeetIsAskedAgainWhereAMovedFixtureMayMatterToIt) {
  Posts posts;
  const std::string far = BoxStl(-3000, 0, 50);
  const JobInputs inputs = posts.Inputs(far);
  const PlannedJob first = posts.Plan(far, NoCheckpoints());
  std::vector<PassResult> passes = first.plan.passes;
  // Counted from elsewhere, so that the best rotation of both is not that of the first.
  Eigen::Vector3d& reference = passes.back().rotation_reference;
  reference = Eigen::AngleAxisd(2.2, passes.back().points[0].point.normal) * reference;
  const auto compare = [&](const JobInputs& of, const PreparedJob& prepared, size_t count,
                           const CheckpointStore& kept) {
    return HashOfValues(
        CompareFixed(of, prepared, {passes.begin(), passes.begin() + count}, kept, {.threads = 1}));
  };
  const test::MemoryCheckpoints known;
  compare(inputs, first.prepared, 1, known);
  const std::string alone = known.stages.at("fixed-0").front().second;
  const std::string before = compare(inputs, first.prepared, 2, known);
  EXPECT_NE(known.stages.at("fixed-0").front().second, alone) << "else nothing was added";
  const Joints& q = passes[0].points[0].q;
  const Eigen::Vector3d flange = (first.plan.X_WB * ForwardFlange(first.plan.arm, q)).translation();
  size_t kept = 0, another = 0;
  // Where the flange comes by as the tool turns about its axis, as far again from there, and a place that
  // only the first pass alone is near to.
  std::vector<Eigen::Vector3d> places{{1660.15, 643.61, 644.44}};
  const MillingPoint& point = passes[0].points[0].point;
  for (int turn = 0; turn < 36; ++turn)
    places.push_back(point.position +
                     (turn % 4 == 0 ? 2 : 1) *
                         (Eigen::AngleAxisd(DegToRad(10) * turn, point.normal) * (flange - point.position)));
  for (const Eigen::Vector3d& at : places) {
    const std::string near = BoxStl(at.x(), at.y(), at.z(), 20);
    const JobInputs moved = posts.Inputs(near);
    const PreparedJob prepared = PrepareJob(moved, NoCheckpoints(), {.threads = 1});
    const test::MemoryCheckpoints again;
    again.stages = known.stages;
    const std::string found = compare(moved, prepared, 2, again);
    EXPECT_EQ(found, compare(moved, prepared, 2, NoCheckpoints())) << near;
    kept += again.stages == known.stages ? 1 : 0;
    another += found != before ? 1 : 0;
  }
  EXPECT_GT(kept, 2u);
  EXPECT_GT(another, 2u);
}

TEST(KeptPass, AnotherShapeIsAChange) {
  Posts posts;
  const test::MemoryCheckpoints kept;
  posts.Plan(BoxStl(-3000, 0, 50), kept);
  EXPECT_EQ(posts.Plan(BoxStl(-3000, 0, 50, 120), kept).resumed_passes, 2);
  EXPECT_EQ(posts.Plan(BoxStl(-3000, 0, 50, 8000), kept).resumed_passes, 0);
}

// What is there, and what it is called, is part of the question; where it stands is part of the answer.
TEST(KeptPass, AnObstacleMoreOrLessIsAnotherJob) {
  test::TestFolder folder("obstacles");
  test::CopySmallJob(folder);
  const test::MemoryCheckpoints kept;
  const auto resumed = [&] {
    return PlanJob(LoadJobInputs(folder.path() / "job.yaml", {}), kept, {.threads = 1}).resumed_passes;
  };
  EXPECT_EQ(resumed(), 0u);
  EXPECT_EQ(resumed(), 2u);
  folder.Change("cell.yaml", "excluded_pairs: []",
                "  - {name: post, class: fixture, mount: world, shape: {sphere: {diameter_mm: 20}}, pose: "
                "{xyz_mm: [-3000, 0, 50]}}\nexcluded_pairs: []");
  EXPECT_EQ(resumed(), 0u);
  folder.Change("cell.yaml", "name: post", "name: column");
  EXPECT_EQ(resumed(), 0u);
  folder.Change("cell.yaml", "class: fixture, mount: world, shape: {sphere",
                "class: platform, mount: world, shape: {sphere");
  EXPECT_EQ(resumed(), 0u);
}

/// A plan kept in a world with two posts far away.
class CachedPlan {
 public:
  CachedPlan() {
    cell.bodies.push_back(Post("left", -3000));
    cell.bodies.push_back(Post("right", 3000));
    QueryLog looks;
    looks.Add(cell.home, cell.home, 10);
    WritePass(kept, "key", ObstaclesOf(cell), looks.Collected(), laid, plan);
  }
  /// Whether it is read in the cell as it is now.
  bool Holds(bool fits = true) const {
    const auto read = Read(laid, fits);
    EXPECT_TRUE(!read || HashOfValues(*read) == HashOfValues(plan));
    return read.has_value();
  }
  std::optional<PassResult> Read(const Pass& pass, bool fits = true) const {
    return ReadPass(kept, "key", World(cell), ObstaclesOf(cell), pass,
                    [&](const PassResult&) { return fits; });
  }
  Body& last() { return cell.bodies.back(); }
  static Body Post(const std::string& name, double y) {
    return {name, BodyClass::kFixture, Mount::kWorld, 0, Pose(Eigen::Translation3d(0, y, 100)), Sphere{25}};
  }

  Cell cell = test::FreshPlan().prepared.cell;
  Pass laid = test::FreshPlan().prepared.toolpath.passes[0];
  PassResult plan = test::FreshPlan().plan.passes[0];
  test::MemoryCheckpoints kept;
};

TEST(KeptPass, IsReadWhereWhatMovedIsFarFromEveryLook) {
  CachedPlan kept;
  ASSERT_TRUE(kept.Holds());
  EXPECT_EQ(kept.kept.writes, 1) << "nothing has changed";
  kept.last().X_MG.translation().x() = -500;
  EXPECT_TRUE(kept.Holds());
  EXPECT_EQ(kept.kept.writes, 2) << "it is kept as of where they stand now";
  EXPECT_TRUE(kept.Holds());
  EXPECT_EQ(kept.kept.writes, 2);
  EXPECT_FALSE(kept.Holds(false)) << "of other points";
  kept.last().X_MG = kept.cell.X_WB * ForwardFlange(kept.cell.arm, kept.cell.home);
  EXPECT_FALSE(kept.Holds()) << "within the arm at home";
  kept.last() = CachedPlan::Post("right", 3000);
  EXPECT_TRUE(kept.Holds());
  kept.last().name = "other";
  EXPECT_FALSE(kept.Holds());
  kept.cell.bodies.pop_back();
  EXPECT_FALSE(kept.Holds()) << "one is gone";
}

TEST(KeptPass, IsNotReadWhereAnAnswerToldOfWhatMoved) {
  CachedPlan kept;
  QueryLog looks;
  looks.Add(kept.cell.home, kept.cell.home, 10);
  looks.Meet("left");
  kept.kept.kept.clear();
  WritePass(kept.kept, "key", ObstaclesOf(kept.cell), looks.Collected(), kept.laid, kept.plan);
  kept.last().X_MG.translation().x() = -500;  // the other one
  EXPECT_TRUE(kept.Holds());
  kept.cell.bodies[kept.cell.bodies.size() - 2].X_MG.translation().y() -= 1;
  EXPECT_FALSE(kept.Holds());
}

TEST(KeptPass, DamagedBytesAreAsGoodAsNone) {
  CachedPlan kept;
  const std::string bytes = kept.kept.kept.at("key").front();
  for (size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 97) {
    kept.kept.kept["key"] = {bytes.substr(0, length)};
    EXPECT_FALSE(kept.Holds()) << length;
  }
  kept.kept.kept["key"] = {bytes + '\0'};
  EXPECT_FALSE(kept.Holds());
  kept.kept.kept.clear();
  EXPECT_FALSE(kept.Holds());
}

TEST(KeptPass, MillingPointsAreThoseOfTheLaidPass) {
  CachedPlan kept;
  const auto write = [&](const Pass& pass) {
    kept.kept.kept.clear();
    WritePass(kept.kept, "key", ObstaclesOf(kept.cell), {}, pass, kept.plan);
  };
  const auto read = [&](const Pass& pass) { return HashOfValues(kept.Read(pass)); };
  const auto plan = [&] { return HashOfValues(std::optional(kept.plan)); };
  Pass none = kept.laid, other = kept.laid;
  for (MillingPoint& point : none.points) point.position.x() += 1;
  other.points[1].arc_length = 77;
  write(none);
  EXPECT_EQ(read(none), plan()) << "its own, where they differ";
  write(kept.laid);
  EXPECT_EQ(read(kept.laid), plan());
  EXPECT_EQ(kept.Read(other)->points[1].point.arc_length, 77) << "not kept";
  none.points.resize(1);
  EXPECT_FALSE(kept.Read(none));

  // Of a ring left open the plan begins with another point; one of its points has a last bit of its own.
  Pass turned = kept.laid;
  std::rotate(turned.points.begin(), turned.points.begin() + 2, turned.points.end());
  kept.plan.opened_at = static_cast<int>(turned.points.size()) - 2;
  kept.plan.points[1].point.arc_length = std::nextafter(kept.plan.points[1].point.arc_length, 1e9);
  write(turned);
  EXPECT_EQ(read(turned), plan());
  turned.points.back().arc_length = turned.points.front().arc_length = 77;
  EXPECT_EQ(kept.Read(turned)->points[1].point.arc_length, kept.plan.points[1].point.arc_length);
  EXPECT_EQ(kept.Read(turned)->points[2].point.arc_length, 77);
}

// Posts here and there about the ways home: what is kept is what planning anew gives.
TEST(KeptLinkMove, AMovedFixtureCostsOnlyTheGapsItMatters) {
  const PlannedJob& job = test::FreshPlan();
  std::vector<std::pair<LinkMoveEnd, LinkMoveEnd>> ends;
  for (const PassResult& pass : job.plan.passes) {
    const LinkMoveEnd home{-1, -1, job.plan.home}, piece{pass.pass, 0, pass.points.front().q};
    ends.insert(ends.end(), {{home, piece}, {piece, home}});
  }
  const auto plan = [&](double x, double y, double z, const CheckpointStore& checkpoints) {
    Cell cell = job.prepared.cell;
    cell.bodies.push_back(
        {"post", BodyClass::kFixture, Mount::kWorld, 0, Pose(Eigen::Translation3d(x, y, z)), Sphere{30}});
    return PlanLinkMoves(Stations(World(cell), job.prepared.problem), ends, {}, checkpoints, {.threads = 2});
  };
  const auto bytes_of = [](const PlannedLinkMoves& planned) {
    std::string bytes;
    for (const LinkMove& gap : planned.gaps) bytes += HashOfValues(gap);
    return bytes;
  };
  RandomStream random(1, 0);
  size_t kept_gaps = 0, planned_gaps = 0;
  const test::MemoryCheckpoints kept;
  EXPECT_EQ(plan(-3000, 0, 50, kept).resumed, 0u);
  for (int round = 0; round < 40; ++round) {
    const double x = random.Uniform(0, 3000), y = random.Uniform(-2500, 2500), z = random.Uniform(0, 3000);
    const PlannedLinkMoves planned = plan(x, y, z, kept);
    EXPECT_EQ(bytes_of(planned), bytes_of(plan(x, y, z, NoCheckpoints()))) << round;
    kept_gaps += planned.resumed;
    planned_gaps += ends.size() - planned.resumed;
  }
  EXPECT_GT(kept_gaps, 30u);
  EXPECT_GT(planned_gaps, 10u);
}

TEST(WithoutPlaces, ForgetsPoseAndShapeOfWhatStandsStillAlone) {
  const Cell cell = CachedPlan().cell;
  const std::string hash = HashOfValues(WithoutPlaces(cell));
  for (size_t i = 0; i < cell.bodies.size(); ++i) {
    const bool still = ObstaclesOf(cell).contains(cell.bodies[i].name);
    Cell moved = cell, other = cell, renamed = cell;
    moved.bodies[i].X_MG.translation().x() += 1;
    other.bodies[i].shape = Sphere{5};
    renamed.bodies[i].name += "2";
    EXPECT_EQ(HashOfValues(WithoutPlaces(moved)) == hash, still) << cell.bodies[i].name;
    EXPECT_EQ(HashOfValues(WithoutPlaces(other)) == hash, still) << cell.bodies[i].name;
    EXPECT_NE(HashOfValues(WithoutPlaces(renamed)), hash);
  }
}

TEST(KeptPass, ObstaclesAreWhatStandsStillAndIsNoPart) {
  const PlannedJob& job = test::FreshPlan();
  const Obstacles obstacles = ObstaclesOf(job.prepared.cell);
  ASSERT_EQ(obstacles.size(), 1);
  EXPECT_EQ(obstacles.begin()->first, "platform");
}

}  // namespace
}  // namespace millpose
