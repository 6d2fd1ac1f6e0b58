// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/mesh.hpp"

namespace millpose {

/// The edges where a set of a mesh's faces ends: open rims and edges to faces that are not in it.
class RegionBorders {
 public:
  RegionBorders() = default;
  RegionBorders(const Mesh& mesh, const std::function<bool(int face)>& has_face);

  bool empty() const { return borders_.empty(); }
  /// Distance of p from the nearest one, mm; infinite when there is none.
  double Distance(const Eigen::Vector3d& p) const;

 private:
  std::vector<std::array<Eigen::Vector3d, 2>> borders_;
  Bvh tree_;
};

}  // namespace millpose
