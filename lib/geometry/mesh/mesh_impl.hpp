// SPDX-License-Identifier: GPL-3.0-or-later
// What stands behind Mesh, for this module alone.
#pragma once

#include <mutex>

#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/mesh.hpp"

namespace millpose {

struct HalfedgeMesh;  // of plane_slices.cpp

struct Mesh::Impl {
  Triangles triangles;
  std::vector<std::array<int, 3>> neighbours;
  std::vector<Eigen::Vector3d> face_normals;
  Bvh tree;  // over the faces
  // Half of a mesh's memory, which only slicing asks for: made when it first does.
  mutable std::once_flag halfedges_made;
  mutable std::shared_ptr<const HalfedgeMesh> halfedges;
};

}  // namespace millpose
