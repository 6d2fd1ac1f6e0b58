// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "geometry/slice/curve.hpp"
#include "geometry/slice/cylinder_slices.hpp"

namespace millpose {

/// The axis of rings with the direction from which angles about it count, and the sense in which rings turn.
class RingFrame {
 public:
  /// Rings begin in the direction of `reference`, seen along the axis, and turn right-handed about
  /// it; `left_handed`: the other way round.
  RingFrame(const Axis& axis, const Eigen::Vector3d& reference, bool left_handed);

  const Axis& axis() const { return axis_; }
  /// From the axis to a point, across it, mm.
  Eigen::Vector3d Radial(const Eigen::Vector3d& p) const;
  double Height(const Eigen::Vector3d& p) const { return (p - axis_.point).dot(axis_.direction); }
  /// About the axis in the rings' sense, 0..2π, from `seam` on.
  double Angle(const Eigen::Vector3d& p, double seam) const;
  /// Smallest distance of a convex polygon's points from the axis, mm.
  double LeastRadius(const std::vector<Eigen::Vector3d>& polygon) const;

  /// The curve in the rings' sense, whatever side the surface looks to.
  Curve Turned(const Curve& curve) const;
  /// Parameter at which a piece passes the half-plane of a seam in the rings' sense.
  std::optional<double> SeamOn(const CurvePiece& piece, double seam) const;
  /// Turns a closed curve so that it begins at a seam.
  void MoveSeam(Curve& curve, double seam) const;

 private:
  Axis axis_;
  Eigen::Vector3d about_, zero_, quarter_;  // right-handed about the first
};

}  // namespace millpose
