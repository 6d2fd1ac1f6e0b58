// SPDX-License-Identifier: GPL-3.0-or-later
// Where a cutter's axis runs beside a contour.
#pragma once

#include <stop_token>

#include "toolpath/strategies/trim_aside.hpp"

namespace millpose {

/// The way beside a contour, straight between nodes.
struct OffsetPath {
  std::vector<OffsetNode> nodes;  ///< of a closed one the first is not repeated
  bool closed = false;

  size_t Segments() const { return nodes.size() - (closed ? 0 : 1); }
  const OffsetNode& From(size_t segment) const { return nodes[segment]; }
  const OffsetNode& To(size_t segment) const { return nodes[(segment + 1) % nodes.size()]; }
};

/// A corner that the cutter does not reach into.
struct TightCorner {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< of the contour, farthest from the cutter
  double left = 0;                                  ///< material between it and the cutter, mm
};

struct Offset {
  std::vector<OffsetPath> paths;  ///< several where the cutter does not pass a narrow place
  std::vector<TightCorner>
      corners;      ///< that turn by more than the crease, with more than the chord tolerance left
  double lean = 0;  ///< largest angle between the tool axis and that of the contour beside it, rad
};

/// The way of a cutter's axis on the left of a contour, `options.distance` from it (seen along the tool's
/// axis at each place) and nowhere nearer, but for the chord tolerance. Round outer corners it runs in arcs,
/// in inner ones that are tighter than the cutter both sides meet in a point. The tool axis is the contour's,
/// averaged along the way. Throws Interrupted.
Offset OffsetOf(const Contour& contour, const OffsetOptions& options, const std::stop_token& stop);

}  // namespace millpose
