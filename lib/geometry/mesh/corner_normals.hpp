// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace millpose {

/// A normal for each corner of each face: the mean of the normals of the faces around the vertex, weighted
/// with their angles there (Thürmer and Wüthrich 1998: independent of how the surface is cut into triangles),
/// but only of those that are reached over edges at which the surface bends by at most `crease` (rad). So a
/// normal never mixes both sides of a crease.
class CornerNormals {
 public:
  /// `smoothing` (mm): above 0, each normal is the mean over the faces whose centres lie within half of it,
  /// reached without passing a crease, weighted with their areas and 1 − (distance ÷ half)²: for noisy
  /// meshes.
  CornerNormals(const Mesh& mesh, double crease, double smoothing = 0);

  /// The unit normal at a point of a face, interpolated from its corners.
  Eigen::Vector3d At(int face, const Eigen::Vector3d& barycentric) const;
  const std::array<Eigen::Vector3d, 3>& OfFace(int face) const { return normals_[face]; }

 private:
  std::vector<std::array<Eigen::Vector3d, 3>> normals_;
};

/// The angle by which the surface bends over side `k` of a face, rad; 0 at a rim.
double BendAngle(const Mesh& mesh, int face, int k);

}  // namespace millpose
