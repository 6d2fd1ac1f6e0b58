// SPDX-License-Identifier: GPL-3.0-or-later
// The bounded distance against a brute-force oracle over all kinds of shapes.
#include "machine/collision/world.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/base/tier.hpp"
#include "tests/machine/collision/brute_force.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

constexpr int kSides = 24;

/// A shape, and a mesh inscribed in it that is nearer to its surface than `slack`.
struct Case {
  Shape shape;
  Triangles mesh;
  double slack = 0;
};

Triangles Octahedron(double r) {
  Triangles mesh;
  mesh.vertices = {{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}};
  mesh.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return mesh;
}

std::vector<Case> Cases() {
  const Triangles tray = Revolve({{-30, 60}, {40, 90}}, 16);
  const auto sagitta = [](double r) { return r * (1 - std::cos(kPi / kSides)); };
  return {{Box{{100, 60, 20}}, BoxMesh({100, 60, 20}), 0},
          {Sphere{50}, CapsuleMesh(50, 0, kSides), 2 * sagitta(50)},
          {Cylinder{40, 200}, Revolve({{-100, 40}, {100, 40}}, kSides), sagitta(40)},
          {Capsule{30, 100}, CapsuleMesh(30, 100, kSides), 2 * sagitta(30)},
          {Cone{50, 20, 80}, Revolve({{-40, 50}, {40, 20}}, kSides), sagitta(50) + 0.003 * 50},
          {Convex{Octahedron(70).vertices}, Octahedron(70), 0},
          {BoxMesh({80, 80, 80}), BoxMesh({80, 80, 80}), 0},
          {tray, tray, 0}};
}

/// Two bodies: one in the world, one on the flange.
Cell PairCell(const Shape& still, const Pose& X_W, const Shape& moving, const Pose& X_F) {
  Cell cell = EmptyCell();
  cell.bodies = {{"still", BodyClass::kFixture, Mount::kWorld, 0, X_W, still},
                 {"moving", BodyClass::kHolder, Mount::kLink, 6, X_F, moving}};
  return cell;
}

TEST(Distance, MatchesBruteForceForAllKindsOfShapes) {
  constexpr double kBound = 150;
  const int trials = OfTier(2, 12);
  RandomStream random(7, 0);
  const std::vector<Case> cases = Cases();
  const Pose X_WF = ForwardFlange(SampleArm(), HomePose());
  int touching = 0, near = 0;
  for (size_t i = 0; i < cases.size(); ++i) {
    for (size_t j = 0; j < cases.size(); ++j) {
      for (int k = 0; k < trials; ++k) {
        const Pose X_W = X_WF * RandomPose(random, 110), X_F = RandomPose(random, 30);
        const World world(PairCell(cases[i].shape, X_W, cases[j].shape, X_F));
        Checker checker(world);
        const double found = std::max(0.0, checker.Clearance(HomePose(), Phase::kFree, kBound));
        const double slack = cases[i].slack + cases[j].slack;
        const double truth =
            std::min(kBound, BruteDistance(Moved(cases[i].mesh, X_W), Moved(cases[j].mesh, X_WF * X_F)));
        // The oracle's meshes are inscribed: they can only be farther apart.
        EXPECT_LE(found, truth + 1e-6) << "shapes " << i << ", " << j << ", trial " << k;
        EXPECT_GE(found, std::min(kBound, truth) - slack - 1e-6)
            << "shapes " << i << ", " << j << ", trial " << k;
        touching += truth == 0;
        near += truth > 0 && truth < kBound;
      }
    }
  }
  EXPECT_GT(touching, 8 * trials);
  EXPECT_GT(near, 8 * trials);
}

double DistanceFromMesh(const Eigen::Vector3d& p, const Triangles& mesh) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : mesh.faces)
    least = std::min(least, PointTriangle(p, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]));
  return least;
}

TEST(Distance, EndsLieOnTheBodiesAndAreAsFarApartAsTheyAre) {
  RandomStream random(8, 0);
  const std::vector<Case> cases = Cases();
  const Pose X_WF = ForwardFlange(SampleArm(), HomePose());
  std::map<std::pair<size_t, size_t>, int> unknown;
  int known = 0;
  for (size_t i = 0; i < cases.size(); ++i) {
    for (size_t j = 0; j < cases.size(); ++j) {
      for (int k = 0; k < OfTier(4, 24); ++k) {
        const Pose X_W = X_WF * RandomPose(random, 110), X_F = RandomPose(random, 30);
        const World world(PairCell(cases[i].shape, X_W, cases[j].shape, X_F));
        const auto found = Checker(world).Nearest(HomePose(), Phase::kFree, 150);
        if (!found || found->distance <= 0) continue;
        const auto& [first, second] = found->ends;
        if (first == second) {
          ++unknown[{i, j}];
          continue;
        }
        ++known;
        const bool in_order = found->first == "still";
        EXPECT_NEAR((first - second).norm(), found->distance, 2e-3) << i << ", " << j;
        EXPECT_LE(DistanceFromMesh(in_order ? first : second, Moved(cases[i].mesh, X_W)),
                  cases[i].slack + 0.01)
            << i << ", " << j;
        EXPECT_LE(DistanceFromMesh(in_order ? second : first, Moved(cases[j].mesh, X_WF * X_F)),
                  cases[j].slack + 0.01)
            << i << ", " << j;
      }
    }
  }
  EXPECT_GT(known, 100);
  // FCL has none of a sphere (1) and a mesh (6, 7).
  for (const auto& [pair, count] : unknown)
    EXPECT_TRUE(std::min(pair.first, pair.second) == 1 && std::max(pair.first, pair.second) >= 6)
        << pair.first << ", " << pair.second << ": " << count;
}

TEST(Distance, PlaceLiesBetweenTheBodies) {
  const Pose X_WF = ForwardFlange(SampleArm(), HomePose());
  const std::vector<std::pair<Shape, Shape>> pairs{{Box{{100, 100, 100}}, Sphere{20}},
                                                   {BoxMesh({100, 100, 100}), Sphere{20}},
                                                   {BoxMesh({100, 100, 100}), Capsule{20, 10}},
                                                   {BoxMesh({100, 100, 100}), BoxMesh({40, 40, 40})}};
  for (const auto& [still, moving] : pairs) {
    // 50 + 20 mm reach towards each other over 75 mm: 5 mm apart at x = 52.5 in F.
    const World world(PairCell(still, X_WF, moving, At(75, 0, 0)));
    const auto found = Checker(world).At(HomePose(), Phase::kFree);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->distance, 5, 1e-6);
    EXPECT_NEAR((X_WF.inverse() * found->place()).x(), 52.5, 1e-3) << still.index() << moving.index();
  }
}

TEST(Distance, OverlapOfBoxesIsTheirDepth) {
  const Pose X_WF = ForwardFlange(SampleArm(), HomePose());
  const World world(PairCell(Box{{100, 100, 100}}, X_WF, Box{{40, 40, 40}}, At(65, 0, 0)));
  const auto found = Checker(world).At(HomePose(), Phase::kFree);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->distance, -5, 1e-9);
}

}  // namespace
}  // namespace millpose::test
