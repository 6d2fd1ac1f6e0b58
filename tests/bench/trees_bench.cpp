// SPDX-License-Identifier: GPL-3.0-or-later
// Our trees over the triangles of a mesh, CGAL's and FCL's, asked the same: docs/decisions/0061-trees.md.
// Answers are compared before they are timed.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <benchmark/benchmark.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "base/random.hpp"
#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/mesh.hpp"
#include "machine/collision/apart.hpp"
#include "machine/collision/solid.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;
using Kernel = CGAL::Simple_cartesian<double>;
using Facets = std::vector<Kernel::Triangle_3>;
using CgalTree =
    CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Facets::const_iterator>>>;

constexpr double kRound = 400, kAcross = 1500, kNear = 20, kFar = 100;  // mm
constexpr size_t kPoints = 1024;

/// A bumpy torus of about `faces` triangles.
Triangles Torus(int faces) {
  const int rows = static_cast<int>(std::sqrt(faces)), columns = faces / 2 / rows;
  Triangles mesh;
  for (int i = 0; i < rows; ++i)
    for (int k = 0; k < columns; ++k) {
      const double u = 2 * M_PI * i / rows, v = 2 * M_PI * k / columns;
      const double r = kRound + 5 * std::sin(40 * u) * std::sin(20 * v);
      mesh.vertices.emplace_back((kAcross + r * std::cos(v)) * std::cos(u),
                                 (kAcross + r * std::cos(v)) * std::sin(u), r * std::sin(v));
    }
  const auto at = [&](int i, int k) { return i % rows * columns + k % columns; };
  for (int i = 0; i < rows; ++i)
    for (int k = 0; k < columns; ++k) {
      mesh.faces.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      mesh.faces.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  return mesh;
}

/// Places beside the surface, up to `most` off it.
std::vector<Vector3d> Beside(double most) {
  RandomStream random(7, 0);
  std::vector<Vector3d> points;
  for (size_t i = 0; i < kPoints; ++i) {
    const double u = random.Uniform(0, 2 * M_PI), v = random.Uniform(0, 2 * M_PI);
    const double r = kRound + random.Uniform(-most, most);
    points.emplace_back((kAcross + r * std::cos(v)) * std::cos(u), (kAcross + r * std::cos(v)) * std::sin(u),
                        r * std::sin(v));
  }
  return points;
}

Kernel::Point_3 PointOf(const Vector3d& p) { return {p.x(), p.y(), p.z()}; }

std::vector<Eigen::AlignedBox3d> BoxesOf(const Triangles& triangles) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const auto& face : triangles.faces) {
    boxes.emplace_back();
    for (const int v : face) boxes.back().extend(triangles.vertices[static_cast<size_t>(v)]);
  }
  return boxes;
}

/// The three trees over one mesh.
struct Trees {
  explicit Trees(int faces) : triangles(Torus(faces)), mesh(triangles), solid(triangles) {
    std::vector<fcl::Triangle> of_fcl;
    for (const auto& [a, b, c] : triangles.faces) {
      const auto of = [&](int v) { return PointOf(triangles.vertices[static_cast<size_t>(v)]); };
      facets.emplace_back(of(a), of(b), of(c));
      of_fcl.emplace_back(a, b, c);
    }
    bvh = Bvh(BoxesOf(triangles));
    cgal.rebuild(facets.begin(), facets.end());
    cgal.accelerate_distance_queries();
    model.beginModel(static_cast<int>(of_fcl.size()), static_cast<int>(triangles.vertices.size()));
    model.addSubModel(triangles.vertices, of_fcl);
    model.endModel();
  }

  double Fcl(const fcl::CollisionGeometryd& shape, const Pose& X, double bound) const {
    fcl::DistanceRequestd request;
    request.enable_signed_distance = false;
    fcl::DistanceResultd result(bound);
    fcl::distance(&model, Pose::Identity(), &shape, X, request, result);
    return result.min_distance;
  }

  Triangles triangles;
  Mesh mesh;
  Solid solid;
  Bvh bvh;
  Facets facets;
  CgalTree cgal;
  fcl::BVHModel<fcl::OBBRSSd> model;
};

const Trees& TreesOf(int faces) {
  static std::map<int, std::unique_ptr<const Trees>> known;
  auto& trees = known[faces];
  if (!trees) trees = std::make_unique<const Trees>(faces);
  return *trees;
}

/// Times `ask(point)` over the points, after it has told the same as `wanted(point)` to `tolerance`.
template <class Ask, class Wanted>
void Run(benchmark::State& state, const std::vector<Vector3d>& points, Ask ask, Wanted wanted,
         double tolerance) {
  for (const Vector3d& p : points)
    if (std::abs(ask(p) - wanted(p)) > tolerance) return state.SkipWithError("another answer");
  size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(ask(points[i++ % points.size()]));
}

double Closest(const Trees& trees, const Vector3d& p) { return trees.mesh.Closest(p).distance; }

void ClosestOurs(benchmark::State& state) {
  const Trees& trees = TreesOf(static_cast<int>(state.range(0)));
  const auto ask = [&](const Vector3d& p) { return Closest(trees, p); };
  Run(state, Beside(kFar), ask, ask, 0);
}

void ClosestCgal(benchmark::State& state) {
  const Trees& trees = TreesOf(static_cast<int>(state.range(0)));
  Run(
      state, Beside(kFar),
      [&](const Vector3d& p) {
        const Kernel::Point_3 of = PointOf(p);
        const auto found = trees.cgal.closest_point_and_primitive(of);
        return std::sqrt(CGAL::squared_distance(found.first, of));
      },
      [&](const Vector3d& p) { return Closest(trees, p); }, 1e-6);
}

void ClosestFcl(benchmark::State& state) {
  const Trees& trees = TreesOf(static_cast<int>(state.range(0)));
  const double radius = 1e-9;
  const fcl::Sphered point(radius);
  Run(
      state, Beside(kFar),
      [&](const Vector3d& p) {
        return trees.Fcl(point, Pose(Eigen::Translation3d(p)), std::numeric_limits<double>::max());
      },
      [&](const Vector3d& p) { return Closest(trees, p); }, 1e-6);
}

Eigen::AlignedBox3d Around(const Vector3d& p) {
  return {p - Vector3d::Constant(kNear), p + Vector3d::Constant(kNear)};
}

Kernel::Iso_cuboid_3 CuboidOf(const Eigen::AlignedBox3d& box) {
  return {PointOf(box.min()), PointOf(box.max())};
}

double CountByCgal(const Trees& trees, const Vector3d& p) {
  return static_cast<double>(trees.cgal.number_of_intersected_primitives(CuboidOf(Around(p))));
}

/// Our tree names the faces whose box meets it; as its callers do, each of them is then looked at.
void FacesInBoxOurs(benchmark::State& state) {
  const Trees& trees = TreesOf(static_cast<int>(state.range(0)));
  Run(
      state, Beside(kNear / 2),
      [&](const Vector3d& p) {
        const Eigen::AlignedBox3d box = Around(p);
        const Kernel::Iso_cuboid_3 cuboid = CuboidOf(box);
        double count = 0;
        trees.bvh.ForEachIn(box, [&](int face) {
          count += CGAL::do_intersect(trees.facets[static_cast<size_t>(face)], cuboid) ? 1 : 0;
        });
        return count;
      },
      [&](const Vector3d& p) { return CountByCgal(trees, p); }, 0);
}

void FacesInBoxCgal(benchmark::State& state) {
  const Trees& trees = TreesOf(static_cast<int>(state.range(0)));
  const auto ask = [&](const Vector3d& p) { return CountByCgal(trees, p); };
  Run(state, Beside(kNear / 2), ask, ask, 0);  // FacesInBoxOurs and -Fcl are held against it
}

void FacesInBoxFcl(benchmark::State& state) {
  const Trees& trees = TreesOf(static_cast<int>(state.range(0)));
  const fcl::Boxd box(Vector3d::Constant(2 * kNear));
  fcl::CollisionRequestd request;
  request.num_max_contacts = trees.triangles.faces.size();
  request.enable_contact = false;
  Run(
      state, Beside(kNear / 2),
      [&](const Vector3d& p) {
        fcl::CollisionResultd result;
        fcl::collide(&trees.model, Pose::Identity(), &box, Pose(Eigen::Translation3d(p)), request, result);
        return static_cast<double>(result.numContacts());
      },
      [&](const Vector3d& p) { return CountByCgal(trees, p); }, 0);
}

double Inside(const Trees& trees, const Vector3d& p) { return trees.solid.Contains(p) ? 1 : 0; }

void ContainsOurs(benchmark::State& state) {
  const Trees& trees = TreesOf(static_cast<int>(state.range(0)));
  const auto ask = [&](const Vector3d& p) { return Inside(trees, p); };
  Run(state, Beside(kFar), ask, ask, 0);
}

void ContainsCgal(benchmark::State& state) {
  const Trees& trees = TreesOf(static_cast<int>(state.range(0)));
  Run(
      state, Beside(kFar),
      [&](const Vector3d& p) {
        const Kernel::Ray_3 ray(PointOf(p), Kernel::Vector_3(0.8017, 0.2673, 0.5345));
        return static_cast<double>(trees.cgal.number_of_intersected_primitives(ray) % 2);
      },
      [&](const Vector3d& p) { return Inside(trees, p); }, 0);
}

/// A link's box, turned, that is asked whether it keeps a clearance.
const Box kLink{{200, 300, 150}};
constexpr double kClearance = 10, kSure = 1e-5;  // mm

Pose LinkAt(const Vector3d& p) {
  return Eigen::Translation3d(p) * Eigen::AngleAxisd(0.01 * p.x(), Vector3d(0.48, 0.6, 0.64).normalized());
}

/// As the checker asks: FCL where neither planes nor points prove the answer.
void BoxKeepsClearanceOurs(benchmark::State& state) {
  const Trees& trees = TreesOf(static_cast<int>(state.range(0)));
  const Envelope body = EnvelopeOf(kLink, Vector3d::Zero(), kLink.size / 2);
  const fcl::Boxd box(kLink.size);
  const auto by_fcl = [&](const Vector3d& p) {
    return trees.Fcl(box, LinkAt(p), kClearance) < kClearance ? 1.0 : 0.0;
  };
  Run(
      state, Beside(3 * kRound),
      [&](const Vector3d& p) {
        const Pose X = LinkAt(p);
        const TriangleTree& tree = trees.solid.tree();
        if (LeastDistance(body, X, tree, kClearance, kClearance) >= kClearance) return 0.0;
        const DistanceBracket found = BracketDistance(body, X, tree, kClearance, kClearance - kSure);
        if (found.most < kClearance - kSure) return 1.0;
        return found.least >= kClearance ? 0.0 : by_fcl(p);
      },
      by_fcl, 0);
}

void BoxKeepsClearanceFcl(benchmark::State& state) {
  const Trees& trees = TreesOf(static_cast<int>(state.range(0)));
  const fcl::Boxd box(kLink.size);
  const auto ask = [&](const Vector3d& p) {
    return trees.Fcl(box, LinkAt(p), kClearance) < kClearance ? 1.0 : 0.0;
  };
  Run(state, Beside(3 * kRound), ask, ask, 0);
}

/// Building the tree, which a plan does once for each mesh.
void BuildOurs(benchmark::State& state) {
  const Trees& trees = TreesOf(static_cast<int>(state.range(0)));
  const std::vector<Eigen::AlignedBox3d> boxes = BoxesOf(trees.triangles);
  for (auto _ : state) benchmark::DoNotOptimize(Bvh(boxes));
}

void BuildCgal(benchmark::State& state) {
  const Trees& trees = TreesOf(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    CgalTree tree(trees.facets.begin(), trees.facets.end());
    tree.build();
    tree.accelerate_distance_queries();
    benchmark::DoNotOptimize(tree.size());
  }
}

#define MILLPOSE_TREE_BENCH(of) BENCHMARK(of)->Arg(3'000)->Arg(200'000)->Unit(benchmark::kMicrosecond)
MILLPOSE_TREE_BENCH(ClosestOurs);
MILLPOSE_TREE_BENCH(ClosestCgal);
MILLPOSE_TREE_BENCH(ClosestFcl);
MILLPOSE_TREE_BENCH(FacesInBoxOurs);
MILLPOSE_TREE_BENCH(FacesInBoxCgal);
MILLPOSE_TREE_BENCH(FacesInBoxFcl);
MILLPOSE_TREE_BENCH(ContainsOurs);
MILLPOSE_TREE_BENCH(ContainsCgal);
MILLPOSE_TREE_BENCH(BoxKeepsClearanceOurs);
MILLPOSE_TREE_BENCH(BoxKeepsClearanceFcl);
MILLPOSE_TREE_BENCH(BuildOurs);
MILLPOSE_TREE_BENCH(BuildCgal);

}  // namespace
}  // namespace millpose
