// SPDX-License-Identifier: GPL-3.0-or-later
// What stands behind Mesh: the OpenMesh mesh, for the adapters of this module alone, and flat arrays.
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/mesh.hpp"

namespace millpose {

struct OpenMeshTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using OpenMeshTriangles = OpenMesh::TriMesh_ArrayKernelT<OpenMeshTraits>;

struct Mesh::Impl {
  Triangles triangles;
  OpenMeshTriangles open_mesh;  // same numbers of vertices and faces
  std::vector<Eigen::Vector3d> face_normals;
  std::vector<std::array<int, 3>> neighbours;
  Bvh tree;  // over the faces
};

}  // namespace millpose
