// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/mesh.hpp"

namespace millpose {

/// Where a mesh passes through itself.
struct SelfCrossings {
  size_t pairs = 0;      ///< of triangles that meet away from the vertices and edges that they share
  bool complete = true;  ///< false when the search was given up: then `pairs` is what had been found
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< centre of the first triangle of the first pair, mm
};

/// Exact (CGAL's filtered predicates on the coordinates as they are). Vertices at the same place count as
/// one, so pieces that were taken apart at an edge do not cross there. The work is bounded by the number of
/// triangles: soups in which most triangles meet are given up.
/// `body_of_source`, where it is not empty: bodies of a STEP model may touch each other; only pairs within
/// one count.
SelfCrossings FindSelfCrossings(const Mesh& mesh, const std::vector<int>& body_of_source = {});

}  // namespace millpose
