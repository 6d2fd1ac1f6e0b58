// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/collision/world.hpp"

#include "base/error.hpp"
#include "tests/base/refusal.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

std::string ErrorOf(const Cell& cell) {
  return RefusalOf([&] { World world(cell); });
}

TEST(World, ExcludedPairsMustNameBodies) {
  Cell cell = SampleCell();
  cell.excluded_pairs = {{"platfrom", "base"}, {"link2", "nothing_like_it"}};
  const std::string error = ErrorOf(cell);
  EXPECT_NE(error.find("no body 'platfrom'; did you mean 'platform'?"), std::string::npos) << error;
  EXPECT_NE(error.find("no body 'nothing_like_it'"), std::string::npos) << error;
}

TEST(World, AllProblemsOfTheBodiesAreNamed) {
  Cell cell = SampleCell();
  cell.bodies[0].shape = Box{{1, -1, 1}};
  cell.bodies[1].name = "link2";
  cell.bodies[2].link = 7;
  Triangles mesh = BoxMesh({1, 1, 1});
  mesh.faces[3][1] = 8;
  cell.bodies[3].shape = mesh;
  cell.bodies[4].shape = Convex{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}};
  cell.bodies[5].X_MG.translation().x() = std::nan("");
  cell.bodies.back().body_class = BodyClass::kCutter;
  cell.clearances.cutting = -1;
  const std::string error = ErrorOf(cell);
  for (const char* part : {"'base': box of 1 × -1 × 1 mm", "two bodies are named 'link2'", "link 7",
                           "triangle 4 names vertex 8 of 8", "span a volume",
                           "'link5': its pose is not finite", "'platform' is a cutter", "clearance -1 mm"}) {
    EXPECT_NE(error.find(part), std::string::npos) << part << "\n" << error;
  }
}

TEST(World, NeighbouringLinksAndOneRigidChainAreNotPairs) {
  Cell cell = EmptyCell();
  const auto add = [&](std::string name, BodyClass c, Mount mount, int link) {
    cell.bodies.push_back({std::move(name), c, mount, link, Pose::Identity(), Sphere{3000}});
  };
  add("base", BodyClass::kLink, Mount::kLink, 0);
  add("link1", BodyClass::kLink, Mount::kLink, 1);
  add("floor", BodyClass::kPlatform, Mount::kWorld, 0);
  add("part", BodyClass::kWorkpiece, Mount::kWorkpiece, 0);
  cell.excluded_pairs = {{"floor", "link1"}, {"link1", "part"}};
  // All overlap, yet base–link1 are neighbours, base, floor and part stand still, the rest is excluded.
  EXPECT_EQ(Checker(World(cell)).Clearance(HomePose(), Phase::kFree, 100), 100);
  add("spindle", BodyClass::kSpindle, Mount::kTool, 0);
  add("flange", BodyClass::kLink, Mount::kLink, 6);
  cell.excluded_pairs.insert(cell.excluded_pairs.end(), {{"spindle", "base"},
                                                         {"spindle", "link1"},
                                                         {"spindle", "floor"},
                                                         {"spindle", "part"},
                                                         {"flange", "base"},
                                                         {"flange", "link1"},
                                                         {"flange", "floor"},
                                                         {"flange", "part"}});
  EXPECT_EQ(Checker(World(cell)).Clearance(HomePose(), Phase::kFree, 100), 100);
  // A body that is no link is checked against the neighbouring link too.
  add("cable", BodyClass::kFixture, Mount::kLink, 5);
  const auto found = Checker(World(cell)).At(HomePose(), Phase::kFree);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->first == "cable" || found->second == "cable");
}

}  // namespace
}  // namespace millpose::test
