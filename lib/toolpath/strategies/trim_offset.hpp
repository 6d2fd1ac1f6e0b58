// SPDX-License-Identifier: GPL-3.0-or-later
// Where a cutter's axis runs beside a contour.
#pragma once

#include <stop_token>

#include "surface/bvh.hpp"
#include "toolpath/strategies/trim_contour.hpp"

namespace millpose {

/// A place of the tool with its tip in the part's surface.
struct OffsetNode {
  Eigen::Vector3d place;  ///< on the tool's axis, beside the contour
  Eigen::Vector3d axis;   ///< unit vector
};

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

/// How far contours lie from a tool's axis.
class ContourDistance {
 public:
  /// `reach` (mm): farther segments are not looked at.
  ContourDistance(const Contour& contour, double reach);
  /// From the line through `place` along `axis` to the nearest segment, mm; infinite beyond the reach.
  double At(const Eigen::Vector3d& place, const Eigen::Vector3d& axis) const;

 private:
  Contour contour_;
  double reach_;
  Bvh tree_;
};

struct Offset {
  std::vector<OffsetPath> paths;  ///< several where the cutter does not pass a narrow place
  std::vector<TightCorner>
      corners;  ///< that turn by more than the crease, with more than the chord tolerance left
};

/// The way of a cutter's axis on the left of a contour, `distance` mm from it (seen along the tool's axis at
/// each place) and nowhere nearer, but for 2 µm. Round outer corners it runs in arcs, cut into chords within
/// `chord` (mm). A contour that turns by up to `crease` (rad) at a place where the cutter does not reach it
/// counts as a round one cut into facets. Throws Interrupted.
Offset OffsetOf(const Contour& contour, double distance, double chord, double crease,
                const std::stop_token& stop);

}  // namespace millpose
