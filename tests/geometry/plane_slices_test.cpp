// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/slice/plane_slices.hpp"

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/units.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

double Length(const Curve& curve) {
  double length = 0;
  for (const CurvePiece& piece : curve.pieces) length += (piece.end - piece.start).norm();
  return length;
}

void ExpectOnMesh(const Mesh& mesh, const Curve& curve) {
  for (size_t i = 0; i < curve.pieces.size(); ++i) {
    const CurvePiece& piece = curve.pieces[i];
    for (const double t : {0.0, 0.3, 0.5, 1.0})
      EXPECT_LT(mesh.ClosestOnFace(piece.At(t), piece.face).distance, 1e-9);
    const CurvePiece& next = curve.pieces[(i + 1) % curve.pieces.size()];
    if (i + 1 < curve.pieces.size() || curve.closed) {
      EXPECT_EQ(piece.end, next.start);
    }
  }
}

TEST(PlaneSlices, CylinderGivesClosedRingsInOrder) {
  const Mesh mesh = SoundMesh(CylinderShape(100, 50, 90, 4));
  const std::vector<double> heights{1, 12.5, 20, 49};
  const auto slices = SliceByPlanes(mesh, Eigen::Vector3d::UnitZ(), heights, {});
  ASSERT_EQ(slices.size(), heights.size());
  const double polygon = 90 * 2 * 100 * std::sin(kPi / 90);
  for (size_t i = 0; i < slices.size(); ++i) {
    ASSERT_EQ(slices[i].size(), 1);
    EXPECT_TRUE(slices[i][0].closed);
    EXPECT_NEAR(Length(slices[i][0]), polygon, 1e-6);
    ExpectOnMesh(mesh, slices[i][0]);
    for (const CurvePiece& piece : slices[i][0].pieces) {
      EXPECT_NEAR(piece.start.z(), heights[i], 1e-9);
      // plane normal × surface normal: counter-clockwise about z
      EXPECT_GT(Eigen::Vector3d::UnitZ().cross(mesh.FaceNormal(piece.face)).dot(piece.Direction(0.5)), 0.99);
    }
  }
}

TEST(PlaneSlices, LieOnTheMeshInAnyDirection) {
  const Mesh mesh = SoundMesh(SphereShape(80, 24));
  for (const Eigen::Vector3d& normal :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.6, 0, 0.8), Eigen::Vector3d(1, 1, 1)}) {
    const auto slices = SliceByPlanes(mesh, normal.normalized(), {-70, -20, 0, 33.3}, {});
    for (const auto& curves : slices) {
      ASSERT_EQ(curves.size(), 1);
      EXPECT_TRUE(curves[0].closed);
      ExpectOnMesh(mesh, curves[0]);
    }
  }
}

TEST(PlaneSlices, OpenSurfacesGiveOpenCurvesAlongPlaneNormalCrossSurfaceNormal) {
  const Mesh mesh = SoundMesh(GridShape(4, 3, 10));
  const auto slices = SliceByPlanes(mesh, Eigen::Vector3d::UnitY(), {5, 10, 40}, {});
  ASSERT_EQ(slices[0].size(), 1);
  EXPECT_FALSE(slices[0][0].closed);
  EXPECT_NEAR(slices[0][0].pieces.front().start.x(), 0, 1e-12);
  EXPECT_NEAR(slices[0][0].pieces.back().end.x(), 40, 1e-12);
  ASSERT_EQ(slices[1].size(), 1);  // along a row of edges: both faces are known
  EXPECT_NEAR(Length(slices[1][0]), 40, 1e-9);
  for (const CurvePiece& piece : slices[1][0].pieces) EXPECT_GE(piece.other_face, 0);
  EXPECT_TRUE(slices[2].empty());
}

TEST(PlaneSlices, StopWhenAsked) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(
      SliceByPlanes(SoundMesh(GridShape(1, 1, 1)), Eigen::Vector3d::UnitX(), {0.5}, source.get_token()),
      Interrupted);
}

// What is sliced is made at the first call, whichever thread makes it.
TEST(PlaneSlices, AreTheSameFromSeveralThreads) {
  const std::vector<double> heights{3, 20, 41};
  const auto slice = [&](const Mesh& mesh) {
    return SliceByPlanes(mesh, Eigen::Vector3d::UnitZ(), heights, {});
  };
  const auto alone = slice(SoundMesh(CylinderShape(100, 50, 60, 4)));
  const Mesh mesh = SoundMesh(CylinderShape(100, 50, 60, 4));
  std::vector<std::vector<std::vector<Curve>>> found(8);
  ParallelFor(found.size(), 4, {}, [&](size_t i) { found[i] = slice(mesh); });
  for (const auto& slices : found) {
    ASSERT_EQ(slices.size(), alone.size());
    for (size_t i = 0; i < slices.size(); ++i) {
      ASSERT_EQ(slices[i].size(), 1u);
      ASSERT_EQ(slices[i][0].pieces.size(), alone[i][0].pieces.size());
      for (size_t k = 0; k < slices[i][0].pieces.size(); ++k) {
        EXPECT_EQ(slices[i][0].pieces[k].start, alone[i][0].pieces[k].start);
        EXPECT_EQ(slices[i][0].pieces[k].face, alone[i][0].pieces[k].face);
      }
    }
  }
}

// Which MakeManifold would have taken apart.
TEST(PlaneSlices, FansThatMeetInOneVertexAreABug) {
  Triangles mesh = BoxShape({0, 0, 0}, {1, 1, 1});
  const Triangles other = BoxShape({1, 1, 1}, {2, 2, 2});
  const auto shift = static_cast<int>(mesh.vertices.size());
  int common = -1, of_other = -1;
  for (int v = 0; v < shift; ++v)
    for (int w = 0; w < static_cast<int>(other.vertices.size()); ++w)
      if (mesh.vertices[v] == other.vertices[w]) common = v, of_other = w;
  ASSERT_GE(common, 0);
  for (const auto& p : other.vertices) mesh.vertices.push_back(p);
  for (std::array<int, 3> face : other.faces) {
    for (int& v : face) v = v == of_other ? common : v + shift;
    mesh.faces.push_back(face);
  }
  EXPECT_THROW(SliceByPlanes(Mesh(mesh), Eigen::Vector3d::UnitZ(), {0.5}, {}), std::logic_error);
}

}  // namespace
}  // namespace millpose
