// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh in each format, for tests. Polygons are kept where the format has them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "geometry/mesh/triangles.hpp"

namespace millpose {

/// Vertices and faces of three corners or more.
struct PolygonMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::vector<int>> faces;
};

PolygonMesh Polygons(const Triangles& triangles);

/// The mesh by format: "stl", "stl text", "obj", "ply", "ply little", "ply big", "off". STL has triangles
/// alone: polygons must be convex for it.
std::map<std::string, std::string> InAllFormats(const PolygonMesh& mesh);

}  // namespace millpose
