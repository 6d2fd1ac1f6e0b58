// SPDX-License-Identifier: GPL-3.0-or-later
// Proven lower bounds of distances against a brute-force oracle.
#include "machine/collision/apart.hpp"

#include "machine/collision/fcl_part.hpp"
#include "tests/machine/collision/brute_force.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

constexpr int kFacets = 24;
constexpr double kFarthest = 300;

/// A convex shape, and a mesh inscribed in it.
struct Sample {
  Shape shape;
  Triangles mesh;
};

std::vector<Sample> Bodies() {
  const Triangles box = BoxMesh({100, 60, 20});
  return {{Box{{100, 60, 20}}, box},
          {Convex{box.vertices}, box},
          {Sphere{50}, CapsuleMesh(50, 0, kFacets)},
          {Cylinder{40, 200}, Revolve({{-100, 40}, {100, 40}}, kFacets)},
          {Capsule{30, 100}, CapsuleMesh(30, 100, kFacets)},
          {Cone{50, 20, 80}, Revolve({{-40, 50}, {40, 20}}, kFacets)}};
}

double Least(const FclPart& body, const Pose& X_MG, const TriangleTree& tree, double bound, double enough) {
  return LeastDistance(body.envelope, X_MG, tree, bound, enough);
}

TEST(Apart, NeverExceedsTheDistanceAndComesNearIt) {
  RandomStream random(11, 0);
  const std::vector<Triangles> meshes{Revolve({{-30, 60}, {40, 90}}, 16), BoxMesh({80, 200, 5})};
  double proven = 0, distances = 0;
  for (const Sample& body : Bodies()) {
    const FclPart part = MakePart(body.shape);
    for (const Triangles& mesh : meshes) {
      const TriangleTree tree(mesh.vertices, mesh.faces);
      for (int trial = 0; trial < 15; ++trial) {
        const Pose X_MG = RandomPose(random, 180);
        const double truth = BruteDistance(mesh, Moved(body.mesh, X_MG));
        const double least = Least(part, X_MG, tree, kFarthest, 0);
        EXPECT_LE(least, truth + 1e-9) << "shape " << body.shape.index() << ", trial " << trial;
        EXPECT_GE(least, 0);
        proven += std::min(least, kFarthest), distances += std::min(truth, kFarthest);
      }
    }
  }
  EXPECT_GT(proven, 0.85 * distances);
}

TEST(Apart, StopsWhereThereIsNotEnough) {
  RandomStream random(12, 0);
  const Triangles mesh = Revolve({{-30, 60}, {40, 90}}, 16);
  const TriangleTree tree(mesh.vertices, mesh.faces);
  const FclPart part = MakePart(Cylinder{40, 200});
  int enough = 0, less = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Pose X_MG = RandomPose(random, 180);
    const double all = Least(part, X_MG, tree, kFarthest, 0), some = Least(part, X_MG, tree, 40, 15);
    if (all >= 15) {
      EXPECT_DOUBLE_EQ(some, std::min(all, 40.0));
      ++enough;
    } else {
      EXPECT_LT(some, 15);
      ++less;
    }
  }
  EXPECT_GT(enough, 30);
  EXPECT_GT(less, 30);
}

TEST(Bracket, HoldsTheDistanceAndIsNarrow) {
  RandomStream random(14, 0);
  const std::vector<Triangles> meshes{Revolve({{-30, 60}, {40, 90}}, 16), BoxMesh({80, 200, 5})};
  int narrow = 0, trials = 0, near = 0;
  for (const Sample& body : Bodies()) {
    const FclPart part = MakePart(body.shape);
    if (part.envelope.kind == Envelope::Kind::kHull) continue;
    // The other shapes' meshes are inscribed.
    const double farther = std::holds_alternative<Box>(body.shape) ? 1e-7 : 2;
    for (const Triangles& mesh : meshes) {
      const TriangleTree tree(mesh.vertices, mesh.faces);
      for (int trial = 0; trial < 40; ++trial) {
        const Pose X_MG = RandomPose(random, 180);
        const double truth = BruteDistance(mesh, Moved(body.mesh, X_MG));
        const DistanceBracket found = BracketDistance(part.envelope, X_MG, tree, kFarthest, 0);
        EXPECT_LE(found.least, std::min(truth, kFarthest) + 1e-7);
        EXPECT_GE(found.most, truth - farther);
        EXPECT_GE(found.least, 0);
        narrow += found.most - found.least < 1e-3;
        ++trials;
        // What is nearer than asked for is seen to be, and no more is said.
        const DistanceBracket early = BracketDistance(part.envelope, X_MG, tree, kFarthest, 40);
        if (early.most >= 40) continue;
        ++near;
        EXPECT_GE(early.most, truth - farther);
        EXPECT_EQ(early.least, 0);
      }
    }
  }
  EXPECT_GT(narrow, 0.75 * trials) << trials;
  EXPECT_GT(near, trials / 10);
}

TEST(Bracket, OfTwoBodiesHoldsTheDistanceAndIsNarrow) {
  RandomStream random(15, 0);
  int narrow = 0, trials = 0, apart = 0;
  const auto closed_form = [](const Sample& body) {
    return MakePart(body.shape).envelope.kind != Envelope::Kind::kHull;
  };
  for (const Sample& first : Bodies()) {
    for (const Sample& second : Bodies()) {
      if (!closed_form(first) || !closed_form(second)) continue;
      const FclPart a = MakePart(first.shape), b = MakePart(second.shape);
      // Their meshes are inscribed.
      const double farther = first.shape.index() + second.shape.index() == 0 ? 1e-7 : 3;
      for (int trial = 0; trial < 25; ++trial) {
        const Pose X_AB = RandomPose(random, 180);
        const DistanceBracket found = BracketDistance(a.envelope, X_AB, b.envelope);
        const double truth = BruteDistance(first.mesh, Moved(second.mesh, X_AB));
        EXPECT_LE(found.least, truth + 1e-7);
        EXPECT_GE(found.most, truth - farther);
        EXPECT_LE(found.least, found.most);
        // No less than what FCL's plane between them proves.
        const BoundedDistance measured =
            DistanceUpTo(PlacePart(a, Pose::Identity()), PlacePart(b, X_AB), kFarthest);
        EXPECT_GE(found.most, measured.distance - 1e-6);
        narrow += found.most - found.least < 1e-3;
        apart += truth > 1;
        ++trials;
      }
    }
  }
  EXPECT_GT(narrow, 0.75 * apart) << trials;
  EXPECT_GT(apart, trials / 2);
}

TEST(Apart, WhatAClosedMeshSwallowsIsNotFree) {
  Triangles skin = BoxMesh({400, 400, 400});
  const FclPart block = MakePart(skin);
  skin.faces.pop_back();
  const FclPart open = MakePart(skin);
  for (const Sample& body : Bodies()) {
    const FclPart part = MakePart(body.shape);
    const Placed inside = PlacePart(part, Pose::Identity());
    EXPECT_EQ(ProvenDistance(PlacePart(block, Pose::Identity()), inside, 10, 10), 0) << body.shape.index();
    EXPECT_EQ(ProvenDistance(inside, PlacePart(block, Pose::Identity()), 10, 10), 0) << body.shape.index();
    EXPECT_EQ(ProvenDistance(PlacePart(open, Pose::Identity()), inside, 10, 10), 10) << body.shape.index();
  }
}

TEST(Apart, ProvesNoMoreThanTheDistanceOfTwoConvexParts) {
  RandomStream random(13, 0);
  double proven = 0, distances = 0;
  for (const Sample& a : Bodies()) {
    const FclPart first = MakePart(a.shape);
    for (const Sample& b : Bodies()) {
      const FclPart second = MakePart(b.shape);
      for (int trial = 0; trial < 4; ++trial) {
        const Pose X_A = RandomPose(random, 150), X_B = RandomPose(random, 150);
        const double truth = std::min(kFarthest, BruteDistance(Moved(a.mesh, X_A), Moved(b.mesh, X_B)));
        const double least = ProvenDistance(PlacePart(first, X_A), PlacePart(second, X_B), kFarthest, 0);
        EXPECT_LE(least, truth + 1e-9);
        proven += least, distances += truth;
      }
    }
  }
  EXPECT_GT(proven, 0.8 * distances);
}

TEST(Apart, ProvesNoMoreThanTheDistanceOfTwoMeshes) {
  RandomStream random(15, 0);
  const std::vector<Triangles> meshes{Revolve({{-30, 60}, {40, 90}}, 12), BoxMesh({80, 200, 5}),
                                      Revolve({{-90, 20}, {90, 25}}, 8)};
  int proven = 0, apart = 0;
  for (const Triangles& a : meshes)
    for (const Triangles& b : meshes) {
      const FclPart first = MakePart(a), second = MakePart(b);
      for (int trial = 0; trial < 30; ++trial) {
        const Pose X_A = RandomPose(random, 200), X_B = RandomPose(random, 200);
        const double truth = std::min(kFarthest, BruteDistance(Moved(a, X_A), Moved(b, X_B)));
        const double least = ProvenDistance(PlacePart(first, X_A), PlacePart(second, X_B), kFarthest, 20);
        apart += truth >= 20;
        if (least < 20) continue;  // nothing is proven
        ++proven;
        EXPECT_LE(least, truth + 1e-9);
      }
    }
  EXPECT_GT(proven, 0.6 * apart) << apart;
  // One in the other touches no triangle.
  const FclPart outer = MakePart(BoxMesh({400, 400, 400})), inner = MakePart(BoxMesh({10, 20, 30}));
  const Placed x = PlacePart(outer, Pose::Identity()), y = PlacePart(inner, Pose::Identity());
  EXPECT_EQ(ProvenDistance(x, y, 10, 10), 0);
  EXPECT_EQ(ProvenDistance(y, x, 10, 10), 0);
}

TEST(Apart, BoxesAreApartWhereTheirDistanceSaysSo) {
  RandomStream random(14, 0);
  int apart = 0, near = 0;
  for (const Sample& a : Bodies()) {
    const FclPart first = MakePart(a.shape);
    for (const Sample& b : Bodies()) {
      const FclPart second = MakePart(b.shape);
      for (int trial = 0; trial < 20; ++trial) {
        const Placed x = PlacePart(first, RandomPose(random, 150)),
                     y = PlacePart(second, RandomPose(random, 150));
        const double distance = BoxDistance(x, y), bound = random.Uniform(0, 200);
        EXPECT_EQ(BoxesApart(x, y, bound), distance >= bound);
        EXPECT_TRUE(BoxesApart(x, y, distance));
        EXPECT_FALSE(BoxesApart(x, y, distance + 1e-9));
        (distance >= bound ? apart : near) += 1;
        // A lower bound: no corner of one box is nearer to the other's centre than the boxes allow.
        EXPECT_LE(distance, (x.centre - y.centre).norm());
        EXPECT_NEAR(distance, BoxDistance(y, x), 1e-9);
      }
    }
  }
  EXPECT_GT(apart, 100);
  EXPECT_GT(near, 100);
}

}  // namespace
}  // namespace millpose::test
