// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>
#include <vector>

#include "geometry/slice/curve.hpp"

namespace millpose {

/// Cuts a mesh with the planes normal · x = offset (unit normal, offsets in mm) by CGAL's
/// Polygon_mesh_slicer. For each plane its curves: straight pieces that know their face, directed along plane
/// normal × surface normal, sorted by their first point; closed ones start at a point that does not depend on
/// the mesh's numbering. Throws Interrupted.
std::vector<std::vector<Curve>> SliceByPlanes(const Mesh& mesh, const Eigen::Vector3d& normal,
                                              const std::vector<double>& offsets, std::stop_token stop);

}  // namespace millpose
