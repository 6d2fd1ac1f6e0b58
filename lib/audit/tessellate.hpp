// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes as triangles whose corners lie on the true surface: never outside of it, so that what touches here
// touches in truth.
#pragma once

#include "audit/setup.hpp"

namespace millpose::audit {

Mesh BoxMesh(const Vector3& size);
/// About z, centred.
Mesh Frustum(Real radius_bottom, Real radius_top, Real length);
/// About z, centred; `length` of the cylindrical part, 0 for a sphere.
Mesh CapsuleMesh(Real radius, Real length);
/// Every triangle of three of the points with all others on one side.
Mesh HullMesh(const std::vector<Vector3>& points);

}  // namespace millpose::audit
