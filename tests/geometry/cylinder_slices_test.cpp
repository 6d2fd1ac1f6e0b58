// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/slice/cylinder_slices.hpp"

#include "base/random.hpp"
#include "base/units.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

// Every point of every piece lies on its facet and on the cylinder.
void ExpectOnBoth(const Mesh& mesh, const Axis& axis, double radius, const std::vector<Curve>& curves) {
  for (const Curve& curve : curves)
    for (size_t i = 0; i < curve.pieces.size(); ++i) {
      const CurvePiece& piece = curve.pieces[i];
      for (const double t : {0.0, 0.2, 0.5, 0.8, 1.0}) {
        EXPECT_LT(mesh.ClosestOnFace(piece.At(t), piece.face).distance, 1e-9);
        EXPECT_NEAR(axis.Radius(piece.At(t)), radius, 1e-9);
      }
      if (i + 1 < curve.pieces.size() || curve.closed) {
        EXPECT_LT((piece.end - curve.pieces[(i + 1) % curve.pieces.size()].start).norm(), 1e-9);
      }
    }
}

TEST(CylinderSlices, FlatFaceGivesWholeCircles) {
  const Mesh mesh = SoundMesh(GridShape(10, 10, 10));
  const Axis axis{{51, 48, 7}, Eigen::Vector3d::UnitZ()};
  const auto slices = SliceByCylinders(mesh, axis, {3, 17.5, 40, 60}, {});
  for (size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(slices[i].size(), 1) << i;
    EXPECT_TRUE(slices[i][0].closed);
  }
  double angle = 0;
  for (const CurvePiece& piece : slices[2][0].pieces) angle += piece.angle1 - piece.angle0;
  EXPECT_NEAR(angle, 2 * kPi, 1e-12);  // once round, counter-clockwise about the normal
  EXPECT_EQ(slices[3].size(), 4);      // the corners of the square
  ExpectOnBoth(mesh, axis, 40, slices[2]);
  ExpectOnBoth(mesh, axis, 60, slices[3]);
}

TEST(CylinderSlices, CircleInsideOneTriangleIsFound) {
  Triangles one;
  one.vertices = {{-100, -100, 0}, {100, -100, 20}, {0, 150, 5}};
  one.faces = {{0, 1, 2}};
  const Mesh mesh = SoundMesh(one);
  const Axis axis{{0, -20, 0}, Eigen::Vector3d::UnitZ()};
  const auto slices = SliceByCylinders(mesh, axis, {10}, {});
  ASSERT_EQ(slices[0].size(), 1);
  EXPECT_TRUE(slices[0][0].closed);
  ASSERT_EQ(slices[0][0].pieces.size(), 1);
  ExpectOnBoth(mesh, axis, 10, slices[0]);
}

TEST(CylinderSlices, AgreeWithDenseSamplingOnRandomTriangles) {
  // The length of the arcs in a triangle against counting which of 20,000 points of the ellipse lie in it.
  RandomStream random(11, 0);
  int with_arcs = 0;
  for (int i = 0; i < 400; ++i) {
    Triangles one;
    for (int k = 0; k < 3; ++k)
      one.vertices.push_back({random.Uniform(-2, 2), random.Uniform(-2, 2), random.Uniform(-0.5, 0.5)});
    one.faces = {{0, 1, 2}};
    const Mesh mesh = SoundMesh(one);
    const Eigen::Vector3d n = mesh.FaceNormal(0);
    if (std::abs(n.z()) < 0.2) continue;
    const Axis axis;
    const auto slices = SliceByCylinders(mesh, axis, {1}, {});
    ExpectOnBoth(mesh, axis, 1, slices[0]);
    double angle = 0;
    for (const Curve& curve : slices[0])
      for (const CurvePiece& piece : curve.pieces) angle += std::abs(piece.angle1 - piece.angle0);
    int inside = 0;
    const int samples = 20000;
    for (int k = 0; k < samples; ++k) {
      const double phi = 2 * kPi * k / samples;
      Eigen::Vector3d p(std::cos(phi), std::sin(phi), 0);
      p.z() = n.dot(one.vertices[0] - p) / n.z();
      inside += mesh.ClosestOnFace(p, 0).distance < 1e-9 ? 1 : 0;
    }
    EXPECT_NEAR(angle, 2 * kPi * inside / samples, 8 * kPi / samples) << "triangle " << i;
    with_arcs += inside > 0 ? 1 : 0;
  }
  EXPECT_GT(with_arcs, 100);
}

TEST(CylinderSlices, CurvedSurfaceGivesChainsWithoutGaps) {
  const Mesh mesh = SoundMesh(SphereShape(100, 20));
  const Axis axis{{3, 5, 0}, Eigen::Vector3d(0.1, -0.2, 1).normalized()};
  for (const auto& curves : SliceByCylinders(mesh, axis, {10, 33, 60}, {})) {
    ASSERT_EQ(curves.size(), 2);  // top and bottom
    for (const Curve& curve : curves) EXPECT_TRUE(curve.closed);
  }
  ExpectOnBoth(mesh, axis, 33, SliceByCylinders(mesh, axis, {33}, {})[0]);
}

TEST(CylinderSlices, VerticesOnTheCylinderAreNoTrouble) {
  // A fan whose corners lie exactly on the radius, and a ring through grid vertices.
  const Mesh disc = SoundMesh(CylinderShape(100, 10, 32));
  EXPECT_NO_THROW(SliceByCylinders(disc, {}, {100}, {}));
  const Mesh grid = SoundMesh(GridShape(10, 10, 10));
  const Axis axis{{50, 50, 0}, Eigen::Vector3d::UnitZ()};
  const auto slices = SliceByCylinders(grid, axis, {10, 50}, {});
  ASSERT_EQ(slices[0].size(), 1);
  EXPECT_TRUE(slices[0][0].closed);
  ExpectOnBoth(grid, axis, 10, slices[0]);
}

}  // namespace
}  // namespace millpose
