// SPDX-License-Identifier: GPL-3.0-or-later
// What a person sees of a mesh: faces, and the edges between them.
#pragma once

#include <vector>

#include "base/units.hpp"
#include "geometry/mesh/mesh.hpp"

namespace millpose {

/// A face of the solid model, or, of a mesh without one, triangles that hang together over edges that bend by
/// no more than a crease.
struct FacePart {
  size_t triangles = 0;
  double area = 0;                                   ///< mm², of the triangles
  Eigen::Vector3d place = Eigen::Vector3d::Zero();   ///< on the face, near its middle
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, there
  double radius = 0;                                 ///< mm, where it is a cylinder's; else 0
};

/// Where two faces meet, or one ends: what hangs together of that.
struct EdgePart {
  int first = -1, second = -1;  ///< faces; the second −1 at an open border
  double length = 0;            ///< mm
  bool closed = false;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();   ///< on the edge, near its middle
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit: between those of the faces
  std::vector<std::array<int, 2>> sides;             ///< pairs of vertices of the mesh
};

struct MeshParts {
  std::vector<int> face_of;  ///< by triangle: into `faces`
  std::vector<FacePart> faces;
  std::vector<EdgePart> edges;
};

/// Numbers faces as the solid model does where there is one, else by their first triangle; edges by their
/// faces.
MeshParts FindMeshParts(const Mesh& mesh, double crease = DegToRad(30));

}  // namespace millpose
