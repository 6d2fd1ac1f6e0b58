// SPDX-License-Identifier: GPL-3.0-or-later
// The edge that a trim follows: points on the part with the tool's axis.
#pragma once

#include <optional>

#include "toolpath/strategies/trim.hpp"

namespace millpose {

struct ContourPoint {
  Eigen::Vector3d place;  ///< on the edge, P, mm
  Eigen::Vector3d axis;   ///< of the tool, from tip to holder; unit vector
};

/// The part lies on the right of its way, seen against the axis, and the cutter on the left.
struct Contour {
  std::vector<ContourPoint> points;  ///< of a closed one the first is not repeated
  bool closed = false;

  size_t Segments() const { return points.size() - (closed ? 0 : 1); }
  const ContourPoint& From(size_t segment) const { return points[segment]; }
  const ContourPoint& To(size_t segment) const { return points[(segment + 1) % points.size()]; }
};

/// The contour of the options. Throws InputError for a border that is not distinguished, a line of no length,
/// a missing axis.
Contour ContourOf(const Trim& trim, const StrategyInputs& inputs);

}  // namespace millpose
