// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/corner_normals.hpp"

#include "base/random.hpp"
#include "base/units.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

TEST(CornerNormals, AreNotMixedAcrossCreases) {
  const Mesh mesh = SoundMesh(BoxShape({0, 0, 0}, {1, 2, 3}));
  const CornerNormals normals(mesh, DegToRad(30));
  for (int f = 0; f < mesh.face_count(); ++f)
    for (const Eigen::Vector3d& normal : normals.OfFace(f))
      EXPECT_NEAR((normal - mesh.FaceNormal(f)).norm(), 0, 1e-12);
}

TEST(CornerNormals, AreMixedAcrossASmoothSurfaceAndKeptAtItsEnd) {
  // 72 sides bend by 5° each; the caps meet the wall at 90°.
  const Mesh mesh = SoundMesh(CylinderShape(100, 50, 72, 3));
  const CornerNormals normals(mesh, DegToRad(30));
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d expected = mesh.Corner(f, k);
      expected.z() = 0;
      const bool cap = std::abs(mesh.FaceNormal(f).z()) > 0.5;
      expected = cap ? mesh.FaceNormal(f) : Eigen::Vector3d(expected.normalized());
      EXPECT_NEAR((normals.OfFace(f)[k] - expected).norm(), 0, 1e-9) << f << " " << k;
    }
}

TEST(CornerNormals, DoNotDependOnHowAFaceIsCut) {
  // The corner of a cube has three right angles whatever the diagonals; weighting with areas or counts would
  // differ.
  const Mesh mesh = SoundMesh(BoxShape({0, 0, 0}, {1, 2, 3}));
  const CornerNormals normals(mesh, DegToRad(120));
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d p = mesh.Corner(f, k);
      const Eigen::Vector3d expected =
          Eigen::Vector3d(p.x() > 0 ? 1 : -1, p.y() > 0 ? 1 : -1, p.z() > 0 ? 1 : -1).normalized();
      EXPECT_NEAR((normals.OfFace(f)[k] - expected).norm(), 0, 1e-12);
    }
}

TEST(CornerNormals, BendAngleIsTheOneOfTheShape) {
  const Mesh mesh = SoundMesh(CylinderShape(100, 50, 36));
  int walls = 0;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int other = mesh.Neighbour(f, k);
      if (std::abs(mesh.FaceNormal(f).z()) > 0.5 || std::abs(mesh.FaceNormal(other).z()) > 0.5) continue;
      const double bend = RadToDeg(BendAngle(mesh, f, k));
      EXPECT_TRUE(std::abs(bend) < 1e-6 || std::abs(bend - 10) < 1e-6) << bend;
      walls += bend > 5 ? 1 : 0;
    }
  EXPECT_EQ(walls, 72);
}

TEST(CornerNormals, SmoothingTakesNoiseAwayAndKeepsCreases) {
  // A cylinder's wall of 2 mm facets with 0.05 mm of noise along the normals; caps stay plane.
  Triangles shape = CylinderShape(100, 100, 314, 50);
  RandomStream random(5, 0);
  for (Eigen::Vector3d& p : shape.vertices)
    if (p.z() > 1 && p.z() < 99) p.head<2>() *= 1 + random.Uniform(-0.05, 0.05) / 100;
  const Mesh mesh = SoundMesh(shape);
  const auto worst = [&](double smoothing) {
    const CornerNormals normals(mesh, DegToRad(40), smoothing);
    double largest = 0;
    for (int f = 0; f < mesh.face_count(); ++f) {
      const bool cap = std::abs(mesh.FaceNormal(f).z()) > 0.9;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d p = mesh.Corner(f, k);
        if (!cap && (p.z() < 20 || p.z() > 80)) continue;
        const Eigen::Vector3d exact =
            cap ? Eigen::Vector3d(0, 0, p.z() > 50 ? 1 : -1) : Eigen::Vector3d(p.x(), p.y(), 0).normalized();
        const double error = (normals.OfFace(f)[k] - exact).norm();
        if (cap) {
          EXPECT_LT(error, 1e-9);
        }
        largest = std::max(largest, error);
      }
    }
    return largest;
  };
  const double rough = worst(0), smooth = worst(20);
  EXPECT_GT(rough, 0.02);
  EXPECT_LT(smooth, rough / 5);
}

TEST(CornerNormals, WhereFacetsAreLargerThanTheLengthNothingChanges) {
  const Mesh mesh = SoundMesh(CylinderShape(100, 50, 36));
  const CornerNormals plain(mesh, DegToRad(30)), smoothed(mesh, DegToRad(30), 1);
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(plain.OfFace(f)[k], smoothed.OfFace(f)[k]);
}

}  // namespace
}  // namespace millpose
