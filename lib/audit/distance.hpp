// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "audit/setup.hpp"

namespace millpose::audit {

/// Distance of `p` from a triangle, mm.
Real Distance(const Vector3& p, const std::array<Vector3, 3>& triangle);

/// Distance of `p` from the nearest triangle, every one looked at, mm.
Real Distance(const Vector3& p, const Mesh& mesh);

/// Distance of two triangles, mm; 0 when they cross.
Real Distance(const std::array<Vector3, 3>& a, const std::array<Vector3, 3>& b);

/// Distance of two meshes in one frame, every pair of triangles looked at that can be nearer than `bound`,
/// mm; `bound` when none is. Knows no inside.
Real Distance(const Mesh& a, const Mesh& b, Real bound);

/// Every edge of the mesh is shared by two triangles (corners equal to 1e-6 mm).
bool IsClosed(const Mesh& mesh);

/// Whether a ray from `p` crosses the closed mesh an odd number of times; a ray that passes near an edge is
/// cast anew.
bool IsInside(const Vector3& p, const Mesh& mesh);

}  // namespace millpose::audit
