// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/units.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {

/// A part of a cylinder's wall about y, 100 mm long, in `rows` facets from 10° to 80° of its slope; facing
/// outwards (up, convex) or inwards (concave).
inline Triangles Vault(double radius, int rows, bool convex) {
  Triangles mesh;
  for (int i = 0; i <= rows; ++i)
    for (const double y : {0.0, 100.0}) {
      const double angle = DegToRad(10 + 70.0 * i / rows);
      mesh.vertices.emplace_back(radius * std::cos(angle), y, radius * std::sin(angle));
    }
  for (int i = 0; i < rows; ++i) {
    mesh.faces.push_back({2 * i, 2 * i + 2, 2 * i + 3});
    mesh.faces.push_back({2 * i, 2 * i + 3, 2 * i + 1});
  }
  if (convex)
    for (auto& face : mesh.faces) std::swap(face[1], face[2]);
  return mesh;
}

}  // namespace millpose
