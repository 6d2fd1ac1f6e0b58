// SPDX-License-Identifier: GPL-3.0-or-later
// Forces that are known within bounds.
#pragma once

#include <Eigen/Dense>
#include <algorithm>

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {

/// How sure a force is: its length lies within this share of the stated one, its direction within an angle.
struct ForceBounds {
  double length = 0.3;          ///< share; above 1 the force may vanish, but not turn round
  double angle = DegToRad(20);  ///< rad, 0..π/2
};

/// The forces within bounds of a stated one, as far as their product with a vector goes.
class ForceCone {
 public:
  ForceCone(const Eigen::Vector3d& force, const ForceBounds& bounds)
      : force_(force),
        length_(force.norm()),
        least_(std::max(0.0, 1 - bounds.length)),
        most_(1 + bounds.length),
        angle_(bounds.angle) {}

  /// The largest g·F over them. The least is −Largest(−g).
  double Largest(const Eigen::Vector3d& g) const {
    const double along = g.dot(force_), across = g.cross(force_).norm();
    const double off = std::max(0.0, Atan2(across, along) - angle_);
    const double product = g.norm() * length_ * SinCos(off).cos;
    return product * (product > 0 ? most_ : least_);
  }

 private:
  Eigen::Vector3d force_;
  double length_, least_, most_, angle_;
};

}  // namespace millpose
