// SPDX-License-Identifier: GPL-3.0-or-later
#include <set>
#include <thread>

#include "base/error.hpp"
#include "machine/collision/world.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

Pose ToolPose(const Cell& cell, const Joints& q) {
  return cell.X_WB * ForwardFlange(cell.arm, q) * cell.X_FT;
}

const Joints kMillingPose = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);

TEST(Checker, HomeAndMillingPoseAreFree) {
  const World world(SampleCell());
  Checker checker(world);
  EXPECT_FALSE(checker.At(HomePose(), Phase::kFree));
  EXPECT_FALSE(checker.At(kMillingPose, Phase::kFree));
  EXPECT_EQ(checker.poses_checked(), 2);
}

TEST(Checker, ArmFoldedIntoThePlatformIsNamed) {
  const World world(SampleCell());
  const auto found = Checker(world).At(Degrees(0, 0, 120, 0, 0, 0), Phase::kFree);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->first, "platform");
}

/// The tool with its tip `depth` mm inside a slab, whose face is normal to the tool axis.
Cell CuttingCell(double depth, bool mesh, double bore_radius = 0) {
  Cell cell = SampleCell();
  const Eigen::Vector3d size(300, 300, 100);
  cell.X_WP = ToolPose(cell, kMillingPose) * At(0, 0, depth - 50);
  if (bore_radius == 0) {
    cell.bodies.push_back({"part", BodyClass::kWorkpiece, Mount::kWorkpiece, 0, Pose::Identity(),
                           mesh ? Shape(BoxMesh(size)) : Shape(Box{size})});
    return cell;
  }
  // Four boxes around a square bore, welded in one mesh by their indices only: overlapping closed shells.
  Triangles part;
  for (int side = 0; side < 4; ++side) {
    const Triangles wall = BoxMesh({300, 100, 100});
    const Pose X =
        Pose(Eigen::AngleAxisd(side * kPi / 2, Eigen::Vector3d::UnitZ())) * At(0, 50 + bore_radius, 0);
    const int first = static_cast<int>(part.vertices.size());
    for (const auto& v : wall.vertices) part.vertices.push_back(X * v);
    for (const auto& f : wall.faces) part.faces.push_back({first + f[0], first + f[1], first + f[2]});
  }
  cell.bodies.push_back(
      {"part", BodyClass::kWorkpiece, Mount::kWorkpiece, 0, Pose::Identity(), std::move(part)});
  return cell;
}

TEST(Checker, CutterMayTouchThePartOnlyWhileCutting) {
  for (const bool mesh : {false, true}) {
    const World world(CuttingCell(5, mesh));
    Checker checker(world);
    EXPECT_FALSE(checker.At(kMillingPose, Phase::kCutting));
    const auto found = checker.At(kMillingPose, Phase::kFree);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->first, "part");
    EXPECT_EQ(found->second, "cutter");
  }
}

TEST(Checker, CutterMayTouchOnlyWithItsCuttingLength) {
  for (const bool mesh : {false, true}) {
    // 40 mm of cutting length and 2 mm of clearance: 37.9 mm deep is free, 38.1 mm is not.
    EXPECT_FALSE(Checker(World(CuttingCell(37.9, mesh))).At(kMillingPose, Phase::kCutting));
    const auto found = Checker(World(CuttingCell(38.1, mesh))).At(kMillingPose, Phase::kCutting);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->second, "cutter above its cutting length");
  }
}

TEST(Checker, HolderTouchesInABoreDeeperThanTheCutter) {
  // The bore takes the cutter of 10 mm radius with 3 mm to spare, not the holder that begins at 60 mm.
  EXPECT_FALSE(Checker(World(CuttingCell(55, true, 13))).At(kMillingPose, Phase::kCutting));
  const auto found = Checker(World(CuttingCell(65, true, 13))).At(kMillingPose, Phase::kCutting);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->second, "holder");
}

TEST(Checker, CutterIsKeptFromFixturesInTheCutToo) {
  for (const bool cutting_length : {true, false}) {
    Cell cell = CuttingCell(5, true);
    // A clamp of 20 mm beside the cutter of 10 mm radius, 4 mm away, at its cutting length or above.
    const Pose X_WT = ToolPose(cell, kMillingPose);
    cell.bodies.push_back({"clamp", BodyClass::kFixture, Mount::kWorld, 0,
                           X_WT * At(24, 0, cutting_length ? 10 : 50), Box{{20, 20, 10}}});
    for (const Phase phase : {Phase::kFree, Phase::kCutting}) {
      cell.clearances.free = 10;
      cell.excluded_pairs = {{"part", "cutter"}, {"part", "holder"}, {"part", "spindle"}};
      const auto found = Checker(World(cell)).At(kMillingPose, phase);
      ASSERT_TRUE(found);
      EXPECT_EQ(found->first, "clamp");
      EXPECT_EQ(found->second, "cutter");
      EXPECT_NEAR(found->distance, 4, 1e-5);
      cell.clearances.free = 3.9;
      EXPECT_FALSE(Checker(World(cell)).At(kMillingPose, phase));
    }
  }
}

TEST(Checker, AllowanceAddsToEveryClearanceFromThePart) {
  // 40 mm of cutting length, 2 mm of clearance, 6 mm of material on the part: 31.9 mm deep is free.
  Cell cell = CuttingCell(31.9, true);
  cell.allowance = 6;
  EXPECT_FALSE(Checker(World(cell)).At(kMillingPose, Phase::kCutting));
  cell = CuttingCell(32.1, true);
  EXPECT_FALSE(Checker(World(cell)).At(kMillingPose, Phase::kCutting));
  cell.allowance = 6;
  EXPECT_TRUE(Checker(World(cell)).At(kMillingPose, Phase::kCutting));
  // In the air 10 mm and 6 mm.
  cell = CuttingCell(-15, true);
  EXPECT_FALSE(Checker(World(cell)).At(kMillingPose, Phase::kFree));
  cell.allowance = 6;
  EXPECT_TRUE(Checker(World(cell)).At(kMillingPose, Phase::kFree));
  cell.allowance = -1;
  EXPECT_THROW(World{cell}, InputError);
}

TEST(Checker, StockIsKeptClearOfBetweenCutsOnly) {
  for (const bool mesh : {false, true}) {
    Cell cell = CuttingCell(5, mesh);
    const Eigen::Vector3d size(400, 400, 200);  // 50 mm of it on the part's top
    cell.bodies.push_back({"stock", BodyClass::kStock, Mount::kWorkpiece, 0, Pose::Identity(),
                           mesh ? Shape(BoxMesh(size)) : Shape(Box{size})});
    EXPECT_FALSE(Checker(World(cell)).At(kMillingPose, Phase::kCutting));
    const auto found = Checker(World(cell)).At(kMillingPose, Phase::kFree);
    ASSERT_TRUE(found);
    EXPECT_LE(found->distance, 0);
    // 20 mm over the part and in the stock; 65 mm over it and clear of both.
    cell.X_WP = cell.X_WP * At(0, 0, -25);
    EXPECT_EQ(Checker(World(cell)).At(kMillingPose, Phase::kFree)->first, "stock");
    cell.X_WP = cell.X_WP * At(0, 0, -45);
    EXPECT_FALSE(Checker(World(cell)).At(kMillingPose, Phase::kFree));
  }
}

TEST(Checker, FreeClearanceHoldsForEverythingElse) {
  Cell cell = SampleCell();
  const Pose X_WT = ToolPose(cell, kMillingPose);
  // 80 mm radius of the spindle and a wall of 20 mm: 9 mm apart.
  cell.bodies.push_back(
      {"wall", BodyClass::kFixture, Mount::kWorld, 0, X_WT * At(99, 0, 280), Box{{20, 100, 100}}});
  for (const Phase phase : {Phase::kFree, Phase::kCutting}) {
    const auto found = Checker(World(cell)).At(kMillingPose, phase);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->first, "wall");
    EXPECT_NEAR(found->distance, 9, 1e-5);
  }
  cell.clearances.free = 8.9;
  EXPECT_FALSE(Checker(World(cell)).At(kMillingPose, Phase::kFree));
  cell.clearances.free = 0;
  EXPECT_FALSE(Checker(World(cell)).At(kMillingPose, Phase::kFree));
  cell.clearances.free = 10;
  cell.excluded_pairs = {{"wall", "spindle"}};
  EXPECT_FALSE(Checker(World(cell)).At(kMillingPose, Phase::kFree));
}

TEST(Checker, KeepsOnlyAShareOfTheClearancesWhenAsked) {
  Cell cell = SampleCell();
  const Pose X_WT = ToolPose(cell, kMillingPose);
  cell.bodies.push_back(
      {"wall", BodyClass::kFixture, Mount::kWorld, 0, X_WT * At(99, 0, 280), Box{{20, 100, 100}}});
  const World world(cell);  // 9 mm of 10 mm
  EXPECT_TRUE(Checker(world, 0.91).At(kMillingPose, Phase::kFree));
  EXPECT_FALSE(Checker(world, 0.89).At(kMillingPose, Phase::kFree));
  EXPECT_TRUE(Checker(world, 0.91).Between(kMillingPose, kMillingPose, Phase::kFree));
  EXPECT_FALSE(Checker(world, 0.89).Between(kMillingPose, kMillingPose, Phase::kFree));
  EXPECT_FALSE(Checker(world, 0).At(kMillingPose, Phase::kFree));
}

TEST(Checker, LinkSwallowedByASolidIsFound) {
  Cell cell = SampleCell();
  // All of the arm is far from the surface of this hall-sized solid.
  for (const bool mesh : {false, true}) {
    Cell swallowed = cell;
    const Eigen::Vector3d size(20000, 20000, 20000);
    swallowed.bodies.push_back({"rock", BodyClass::kFixture, Mount::kWorld, 0, Pose::Identity(),
                                mesh ? Shape(BoxMesh(size)) : Shape(Box{size})});
    EXPECT_TRUE(Checker(World(swallowed)).At(HomePose(), Phase::kFree));
    EXPECT_LE(Checker(World(swallowed)).Clearance(HomePose(), Phase::kFree, 100), 0);
  }
  // Without its lid the box is a room.
  Triangles room = BoxMesh({20000, 20000, 20000});
  room.faces.resize(10);
  cell.bodies.push_back({"room", BodyClass::kFixture, Mount::kWorld, 0, Pose::Identity(), room});
  EXPECT_FALSE(Checker(World(cell)).At(HomePose(), Phase::kFree));
}

TEST(Checker, SmallSolidInsideALinkMeshIsFound) {
  Cell cell = SampleCell();
  for (Body& body : cell.bodies) {
    if (body.name == "link3") body.shape = BoxMesh({742, 705, 726});
  }
  const Pose X_WL3 = cell.X_WB * LinkFrames(cell.arm, HomePose())[3];
  cell.bodies.push_back(
      {"pebble", BodyClass::kFixture, Mount::kWorld, 0, X_WL3 * At(0, 100, 40), BoxMesh({5, 5, 5})});
  const auto found = Checker(World(cell)).At(HomePose(), Phase::kFree);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->first, "pebble");
  EXPECT_EQ(found->second, "link3");
}

TEST(Checker, ClearanceIsBoundedAndAgreesWithAt) {
  const Cell cell = CuttingCell(-30, true);
  const World world(cell);
  Checker checker(world);
  EXPECT_NEAR(checker.Clearance(kMillingPose, Phase::kFree, 50), 30, 1e-6);
  EXPECT_EQ(checker.Clearance(kMillingPose, Phase::kFree, 20), 20);
  RandomStream random(3, 0);
  for (int i = 0; i < 300; ++i) {
    const Joints q = RandomJoints(random, cell.arm);
    // In free motion all pairs have one clearance, so both must tell the same.
    EXPECT_EQ(checker.At(q, Phase::kFree).has_value(),
              checker.Clearance(q, Phase::kFree, 100) < cell.clearances.free);
  }
}

TEST(Checker, NearestNamesThePairAndThePlace) {
  const Cell cell = CuttingCell(-30, true);
  const World world(cell);
  Checker checker(world);
  const auto nearest = checker.Nearest(kMillingPose, Phase::kFree, 50);
  ASSERT_TRUE(nearest);
  EXPECT_NEAR(nearest->distance, 30, 1e-6);
  EXPECT_EQ((std::set{nearest->first, nearest->second}), (std::set<std::string>{"cutter", "part"}));
  // Between the cutter's tip, which stands 30 mm off, and the wall.
  const Pose X_WT = cell.X_WB * ForwardFlange(cell.arm, kMillingPose) * cell.X_FT;
  EXPECT_NEAR((X_WT.inverse() * nearest->place()).z(), -15, 0.1);
  EXPECT_FALSE(checker.Nearest(kMillingPose, Phase::kFree, 29.9));
  // Brute force: of a wide bound and a narrow one the same pair, and no other one is nearer.
  RandomStream random(5, 0);
  for (int i = 0; i < 100; ++i) {
    const Joints q = RandomJoints(random, cell.arm);
    const auto wide = checker.Nearest(q, Phase::kFree, 300);
    if (!wide || wide->distance <= 0) continue;
    const auto narrow = checker.Nearest(q, Phase::kFree, wide->distance + 1e-3);
    ASSERT_TRUE(narrow);
    EXPECT_NEAR(narrow->distance, wide->distance, 1e-9);
    EXPECT_EQ(narrow->distance, checker.Clearance(q, Phase::kFree, wide->distance + 1e-3));
  }
}

TEST(Checker, ThreadsAgree) {
  const World world(CuttingCell(5, true));
  std::vector<Joints> poses;
  RandomStream random(11, 0);
  for (int i = 0; i < 200; ++i) poses.push_back(RandomJoints(random, world.cell().arm));
  const auto run = [&](std::vector<double>& out) {
    Checker checker(world);
    for (const Joints& q : poses) out.push_back(checker.Clearance(q, Phase::kFree, 200));
  };
  std::vector<std::vector<double>> results(4);
  {
    std::vector<std::jthread> threads;
    for (auto& result : results) threads.emplace_back([&] { run(result); });
  }
  for (const auto& result : results) EXPECT_EQ(result, results[0]);
}

}  // namespace
}  // namespace millpose::test
