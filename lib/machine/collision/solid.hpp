// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "geometry/mesh/triangles.hpp"
#include "machine/collision/triangle_tree.hpp"

namespace millpose {

/// What FCL does not know of a mesh: where its inside is. A mesh is solid when every edge of it, after
/// welding equal vertices, is shared by an even number of faces; an open mesh is a sheet and has no inside.
class Solid {
 public:
  explicit Solid(const Triangles& mesh);

  bool closed() const { return closed_; }
  /// All triangles, those without area too.
  const TriangleTree& tree() const { return tree_; }
  /// One vertex of every connected component.
  const std::vector<Eigen::Vector3d>& representatives() const { return representatives_; }
  /// Whether `p` (mm, mesh frame) lies inside: the winding number counted along a ray is not 0. Always false
  /// for an open mesh. Points on the surface may count as either.
  bool Contains(const Eigen::Vector3d& p) const;

 private:
  struct Crossings {
    int winding = 0;
    bool doubtful = false;  ///< the ray passed too near an edge to be sure
  };
  void FindTopology(const std::vector<std::array<int, 3>>& faces,
                    const std::vector<Eigen::Vector3d>& vertices);
  Crossings Count(const Eigen::Vector3d& p, const Eigen::Vector3d& direction) const;

  TriangleTree tree_;
  std::vector<Eigen::Vector3d> representatives_;
  bool closed_ = false;
};

}  // namespace millpose
