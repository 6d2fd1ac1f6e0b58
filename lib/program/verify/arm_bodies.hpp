// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "machine/collision/cell.hpp"

namespace millpose {

/// What hangs on the arm, as spheres: how far it is from where it was proven to be clear.
class ArmBodies {
 public:
  explicit ArmBodies(const Cell& cell);

  /// Whether any point of arm and tool may be further apart than `distance` (mm) at joint angles q and p.
  bool MovesFurther(const Joints& q, const Joints& p, double distance) const;
  /// mm: no point of arm and tool is farther from the base.
  double reach() const { return reach_; }
  const Cell& cell() const { return cell_; }

 private:
  struct Ball {
    size_t link;
    Eigen::Vector3d centre;  // in the link's frame, mm
    double radius;           // mm
  };
  const Cell& cell_;
  std::vector<Ball> balls_;
  double reach_ = 0;  // mm: no point is farther from any joint's axis
};

}  // namespace millpose
