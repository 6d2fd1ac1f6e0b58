// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/slice/plane_slices.hpp"

#include "base/error.hpp"
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

}  // namespace
}  // namespace millpose
