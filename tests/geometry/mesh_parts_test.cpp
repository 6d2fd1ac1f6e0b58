// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/mesh_parts.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

TEST(MeshParts, ABoxHasSixFacesAndTwelveEdges) {
  const Mesh mesh = SoundMesh(BoxShape({0, 0, 0}, {10, 20, 30}));
  const MeshParts parts = FindMeshParts(mesh);
  ASSERT_EQ(parts.faces.size(), 6u);
  ASSERT_EQ(parts.edges.size(), 12u);
  double area = 0, length = 0;
  for (const FacePart& face : parts.faces) {
    area += face.area;
    EXPECT_EQ(face.triangles, 2u);
    EXPECT_NEAR(face.normal.cwiseAbs().maxCoeff(), 1, 1e-12);
    // The place lies on the face that the normal belongs to.
    int axis = 0;
    face.normal.cwiseAbs().maxCoeff(&axis);
    const double side = face.normal[axis] > 0 ? Eigen::Vector3d(10, 20, 30)[axis] : 0;
    EXPECT_NEAR(face.place[axis], side, 1e-12);
  }
  for (const EdgePart& edge : parts.edges) {
    length += edge.length;
    EXPECT_FALSE(edge.closed);
    EXPECT_LT(edge.first, edge.second);
    EXPECT_EQ(edge.sides.size(), 1u);
    const Eigen::Vector3d between = (parts.faces[static_cast<size_t>(edge.first)].normal +
                                     parts.faces[static_cast<size_t>(edge.second)].normal)
                                        .normalized();
    EXPECT_LT((edge.normal - between).norm(), 1e-12);
  }
  EXPECT_NEAR(area, 2 * (200 + 300 + 600), 1e-9);
  EXPECT_NEAR(length, 4 * 60, 1e-9);
}

TEST(MeshParts, RoundFacesStayOneAndTheirRimsAreClosed) {
  const MeshParts parts = FindMeshParts(SoundMesh(CylinderShape(10, 5, 48)));
  EXPECT_EQ(parts.faces.size(), 3u);
  ASSERT_EQ(parts.edges.size(), 2u);
  for (const EdgePart& edge : parts.edges) {
    EXPECT_TRUE(edge.closed);
    EXPECT_EQ(edge.sides.size(), 48u);
    EXPECT_NEAR(edge.length, 2 * kPi * 10, 0.1);
  }
}

TEST(MeshParts, OpenBordersAreEdgesOfOneFaceEachByItself) {
  const MeshParts parts = FindMeshParts(SoundMesh(PlateShape(6, 4, 10, {{{{20, 10}, {30, 20}}}})));
  EXPECT_EQ(parts.faces.size(), 1u);
  ASSERT_EQ(parts.edges.size(), 2u);  // the rim and the opening
  std::vector<double> lengths;
  for (const EdgePart& edge : parts.edges) {
    EXPECT_EQ(edge.second, -1);
    EXPECT_TRUE(edge.closed);
    lengths.push_back(edge.length);
  }
  std::ranges::sort(lengths);
  EXPECT_NEAR(lengths[0], 40, 1e-9);
  EXPECT_NEAR(lengths[1], 200, 1e-9);
}

TEST(MeshParts, FacesOfASolidModelKeepTheirNumbers) {
  Triangles box = BoxShape({0, 0, 0}, {10, 10, 10});
  box.source_faces.resize(3);
  for (size_t i = 0; i < box.faces.size(); ++i) box.source.push_back(i < 2 ? 2 : 0);
  const MeshParts parts = FindMeshParts(SoundMesh(box));
  ASSERT_EQ(parts.faces.size(), 3u);
  EXPECT_NEAR(parts.faces[2].area, 100, 1e-9);
  EXPECT_NEAR(parts.faces[0].area, 500, 1e-9);
  EXPECT_EQ(parts.faces[1].triangles, 0u);  // a lost one
  ASSERT_EQ(parts.edges.size(), 1u);
  EXPECT_TRUE(parts.edges[0].closed);
  EXPECT_NEAR(parts.edges[0].length, 40, 1e-9);
}

}  // namespace
}  // namespace millpose
