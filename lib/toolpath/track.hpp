// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/corner_normals.hpp"
#include "geometry/slice/curve.hpp"
#include "toolpath/region.hpp"

namespace millpose {

/// Cuts a curve where it leaves the region and where it passes a crease (the normals on both sides differ by
/// more than `crease`, rad). The borders of the region are met to 1e-7 mm. Parts not longer than
/// `least_length` (mm) are dropped. A closed curve that is cut nowhere stays closed.
std::vector<Curve> ClipToRegion(const Mesh& mesh, const Curve& curve, const Region& region,
                                const CornerNormals& normals, double crease, double least_length);

/// The normal at a point of a piece's face.
Eigen::Vector3d NormalOn(const Mesh& mesh, const CornerNormals& normals, const CurvePiece& piece,
                         const Eigen::Vector3d& p);

}  // namespace millpose
