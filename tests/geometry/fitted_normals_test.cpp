// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/fitted_normals.hpp"

#include "base/random.hpp"
#include "base/units.hpp"
#include "geometry/mesh/corner_normals.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/skins.hpp"

namespace millpose {
namespace {

const std::function<bool(int)> kAllFaces = [](int) { return true; };

// Largest angle (degrees) between a skin's own normals and those of its mesh, at its borders' vertices.
std::pair<double, double> WorstAtBorders(const Skin& skin, const Triangles& triangles) {
  const Mesh mesh = SoundMesh(triangles);
  const CornerNormals rough(mesh, DegToRad(30));
  const FittedNormals fitted(mesh, kAllFaces, DegToRad(30));
  double worst_rough = 0, worst_fitted = 0;
  for (int face = 0; face < mesh.face_count(); ++face)
    for (int k = 0; k < 3; ++k) {
      if (mesh.Neighbour(face, k) >= 0) continue;
      const Eigen::Vector3d& p = mesh.Corner(face, k);
      const Eigen::Vector3d exact = SkinNormal(skin, p), facets = rough.OfFace(face)[k];
      const Eigen::Vector3d normal = fitted.At(p, face, facets);
      worst_rough = std::max(worst_rough, RadToDeg(exact.cross(facets).norm()));
      worst_fitted = std::max(worst_fitted, RadToDeg(exact.cross(normal).norm()));
    }
  return {worst_rough, worst_fitted};
}

TEST(FittedNormals, AtTheBordersOfASkinAreTheSkinsOwn) {
  for (const SkinForm form : {SkinForm::kCylinder, SkinForm::kSphere})
    for (const double radius : {1500.0, 15000.0}) {
      const Skin skin{.form = form, .radius = radius, .corner = 20};
      const auto [rough, fitted] = WorstAtBorders(skin, SkinShape(skin));
      EXPECT_GT(rough, 0.1 * 1500 / radius) << "what the facets' normals are off by";
      EXPECT_LT(fitted, 0.005 * 1500 / radius) << radius;
    }
}

TEST(FittedNormals, ScatteredVerticesGetThoseOfTheFacets) {
  const Skin skin{.corner = 20};
  Triangles rough = SkinShape(skin);
  RandomStream random(1, 2);
  for (Eigen::Vector3d& p : rough.vertices) p.z() += random.Uniform(-0.1, 0.1);
  const Mesh mesh = SoundMesh(rough);
  const CornerNormals normals(mesh, DegToRad(30));
  const FittedNormals fitted(mesh, kAllFaces, DegToRad(30));
  for (int face = 0; face < mesh.face_count(); ++face)
    EXPECT_EQ(fitted.At(mesh.Corner(face, 0), face, normals.OfFace(face)[0]), normals.OfFace(face)[0]);
}

TEST(FittedNormals, FacesBeyondACreaseOrOutOfTheSetDoNotCount) {
  const Mesh cylinder = SoundMesh(CylinderShape(60, 40, 72, 3));
  const auto is_wall = [&](int face) { return std::abs(cylinder.FaceNormal(face).z()) < 0.5; };
  for (const double crease : {DegToRad(30), DegToRad(120)}) {  // by the crease at the rim; by the set alone
    const FittedNormals fitted(cylinder, crease < 1 ? kAllFaces : is_wall, crease);
    double worst_rough = 0, worst_fitted = 0;
    for (int face = 0; face < cylinder.face_count(); ++face) {
      if (!is_wall(face)) continue;
      const Eigen::Vector3d weights(0.7, 0.2, 0.1);
      const Eigen::Vector3d p = weights[0] * cylinder.Corner(face, 0) +
                                weights[1] * cylinder.Corner(face, 1) + weights[2] * cylinder.Corner(face, 2);
      const Eigen::Vector3d exact = Eigen::Vector3d(p.x(), p.y(), 0).normalized();
      const Eigen::Vector3d facet = cylinder.FaceNormal(face);  // as rough as can be
      worst_rough = std::max(worst_rough, RadToDeg(exact.cross(facet).norm()));
      worst_fitted = std::max(worst_fitted, RadToDeg(exact.cross(fitted.At(p, face, facet)).norm()));
    }
    EXPECT_GT(worst_rough, 1);
    EXPECT_LT(worst_fitted, 0.1);
  }
}

}  // namespace
}  // namespace millpose
