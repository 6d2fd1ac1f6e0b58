// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/fitted_normals.hpp"

#include <algorithm>

#include "base/decompositions.hpp"
#include "base/trig.hpp"
#include "geometry/mesh/corner_normals.hpp"

namespace millpose {
namespace {

constexpr size_t kEnough = 20;      // vertices; the ring of faces that brings them is the last
constexpr size_t kLeast = 7;        // of a fit of six numbers
constexpr double kScatter = 0.1;    // share of the distances from the plane
constexpr double kRounding = 2e-5;  // mm, of coordinates in files

}  // namespace

struct FittedNormals::Around {
  std::vector<int> vertices;
  double bend = 0;  // largest between two of the faces, rad
};

FittedNormals::FittedNormals(const Mesh& mesh, std::function<bool(int face)> has_face, double crease)
    : mesh_(mesh), has_face_(std::move(has_face)), crease_(crease) {}

FittedNormals::Around FittedNormals::Gather(int face) const {
  const Triangles& triangles = mesh_.triangles();
  const auto source = [&](int at) { return triangles.source.empty() ? 0 : triangles.source[at]; };
  Around around;
  std::vector<int> faces{face};
  for (size_t begin = 0; begin < faces.size() && around.vertices.size() < kEnough;) {
    const size_t end = faces.size();
    for (; begin < end; ++begin)
      for (int k = 0; k < 3; ++k) {
        const int vertex = triangles.faces[faces[begin]][k], other = mesh_.Neighbour(faces[begin], k);
        if (std::ranges::find(around.vertices, vertex) == around.vertices.end())
          around.vertices.push_back(vertex);
        if (other < 0 || !has_face_(other) || source(other) != source(face) ||
            std::ranges::find(faces, other) != faces.end())
          continue;
        const double bend = BendAngle(mesh_, faces[begin], k);
        if (bend > crease_) continue;
        around.bend = std::max(around.bend, bend);
        faces.push_back(other);
      }
  }
  return around;
}

Eigen::Vector3d FittedNormals::At(const Eigen::Vector3d& p, int face, const Eigen::Vector3d& rough) const {
  const Around around = Gather(face);
  const auto count = static_cast<Eigen::Index>(around.vertices.size());
  if (around.vertices.size() < kLeast || around.bend == 0) return rough;
  const Eigen::Vector3d u = rough.unitOrthogonal(), v = rough.cross(u);
  double scale = 0;
  for (const int vertex : around.vertices) scale += (mesh_.triangles().vertices[vertex] - p).norm();
  scale /= static_cast<double>(count);
  Eigen::MatrixXd terms(count, 6);
  Eigen::VectorXd heights(count), weights(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3d off = mesh_.triangles().vertices[around.vertices[static_cast<size_t>(i)]] - p;
    const double x = off.dot(u) / scale, y = off.dot(v) / scale;
    weights[i] = 1 / (1 + x * x + y * y);  // what is near counts more
    terms.row(i) << 1, x, y, x * x, x * y, y * y;
    heights[i] = off.dot(rough);
  }
  const Eigen::MatrixXd weighted = weights.asDiagonal() * terms;
  const Eigen::VectorXd wanted = weights.cwiseProduct(heights);
  const Eigen::VectorXd plane = LeastSquares(weighted.leftCols(3), wanted);
  const Eigen::VectorXd fit = LeastSquares(weighted, wanted);
  const double off_plane = (weighted.leftCols(3) * plane - wanted).norm();
  const double off_fit = (weighted * fit - wanted).norm();
  if (off_fit > std::max(kScatter * off_plane, kRounding * wanted.size())) return rough;
  const Eigen::Vector3d normal = (rough - fit[1] / scale * u - fit[2] / scale * v).normalized();
  // Facets are never off by more than they bend.
  return Atan2(normal.cross(rough).norm(), normal.dot(rough)) <= around.bend ? normal : rough;
}

}  // namespace millpose
