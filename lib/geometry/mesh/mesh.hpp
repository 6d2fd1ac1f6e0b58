// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <memory>

#include "geometry/mesh/triangles.hpp"

namespace millpose {

/// A point of a surface. `barycentric` holds the weights of the face's corners; they sum to 1.
struct SurfacePoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< mm
  int face = -1;
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
  double distance = 0;  ///< from the point asked about, mm
};

/// An oriented manifold of triangles, with or without rims, immutable; copies share their data. Faces and
/// vertices keep the numbers of the triangles that it was made from. Safe to ask from many threads.
class Mesh {
 public:
  /// `manifold` as MakeManifold leaves it; an edge of more than two faces, or of two that do not run against
  /// each other there, is a bug (std::logic_error with the face).
  explicit Mesh(Triangles manifold);

  const Triangles& triangles() const;
  int face_count() const { return static_cast<int>(triangles().faces.size()); }
  const Eigen::Vector3d& Corner(int face, int k) const;
  /// Unit normal, out of the material.
  const Eigen::Vector3d& FaceNormal(int face) const;
  /// The face over side `k` (from corner k to corner k+1), or -1 at a rim.
  int Neighbour(int face, int k) const;

  /// The point of the surface that is nearest to p; face −1 where none is nearer than `within`, mm.
  SurfacePoint Closest(const Eigen::Vector3d& p,
                       double within = std::numeric_limits<double>::infinity()) const;
  /// The point of one face that is nearest to p.
  SurfacePoint ClosestOnFace(const Eigen::Vector3d& p, int face) const;
  /// All faces within `distance` (mm) of p, ascending.
  std::vector<int> FacesNear(const Eigen::Vector3d& p, double distance) const;
  /// Whether p lies inside, by the parity of crossings of three rays (majority). Meaningful for closed
  /// meshes.
  bool Contains(const Eigen::Vector3d& p) const;

  /// For the adapters of this module alone.
  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Area of a face, mm².
inline double AreaOf(const Mesh& mesh, int face) {
  const Eigen::Vector3d& a = mesh.Corner(face, 0);
  return (mesh.Corner(face, 1) - a).cross(mesh.Corner(face, 2) - a).norm() / 2;
}

}  // namespace millpose
