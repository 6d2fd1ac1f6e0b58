// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

namespace millpose {

/// A triangle soup with shared vertices: what readers return and what interference uses. Coordinates mm.
struct Triangles {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> faces;  ///< indices into `vertices`, counter-clockwise seen from outside
};

}  // namespace millpose
