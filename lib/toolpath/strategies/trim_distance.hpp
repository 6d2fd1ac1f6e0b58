// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/bvh.hpp"
#include "toolpath/strategies/trim_contour.hpp"

namespace millpose {

/// What of a contour lies nearest to a tool's axis.
struct NearestOnContour {
  double distance = std::numeric_limits<double>::infinity();  ///< mm, seen along the axis
  Eigen::Vector3d off = Eigen::Vector3d::Zero();  ///< from the contour to the axis, across the axis, mm
};

/// How far contours lie from a tool's axis.
class ContourDistance {
 public:
  /// `reach` (mm): farther segments are not looked at.
  ContourDistance(const Contour& contour, double reach);
  /// From the line through `place` along `axis` to the nearest segment; infinite beyond the reach.
  NearestOnContour Nearest(const Eigen::Vector3d& place, const Eigen::Vector3d& axis) const;
  /// Its distance alone, mm.
  double At(const Eigen::Vector3d& place, const Eigen::Vector3d& axis) const {
    return Nearest(place, axis).distance;
  }

 private:
  Contour contour_;
  double reach_;
  Bvh tree_;
};

/// Seen along `axis`, from the line through `place` along it to the nearest point of segment ab: a vector
/// across the axis (mm); `share` says where on the segment.
Eigen::Vector3d AcrossToSegment(const Eigen::Vector3d& place, const Eigen::Vector3d& axis,
                                const Eigen::Vector3d& a, const Eigen::Vector3d& b, double& share);

}  // namespace millpose
