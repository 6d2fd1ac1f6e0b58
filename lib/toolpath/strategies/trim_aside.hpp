// SPDX-License-Identifier: GPL-3.0-or-later
// A contour moved aside, as it comes: where corners are narrower than the cutter it runs over itself.
#pragma once

#include "toolpath/strategies/trim_contour.hpp"

namespace millpose {

/// A place of the tool with its tip in the part's surface.
struct OffsetNode {
  Eigen::Vector3d place;  ///< on the tool's axis, beside the contour
  Eigen::Vector3d axis;   ///< unit vector
};

enum class SideKind : uint8_t {
  kAlong,   ///< beside a segment of the contour
  kRound,   ///< a chord of the arc round an outer corner
  kAcross,  ///< over an inner corner, nearer to it than the cutter may come
};

struct AsideSide {
  SideKind kind = SideKind::kAlong;
  size_t at = 0;  ///< the segment, or the corner, by its number
};

/// Side k leads from node k to the next one.
struct Aside {
  std::vector<OffsetNode> nodes;
  std::vector<AsideSide> sides;
  bool closed = false;

  const OffsetNode& From(size_t side) const { return nodes[side]; }
  const OffsetNode& To(size_t side) const { return nodes[(side + 1) % nodes.size()]; }
  OffsetNode At(size_t side, double share) const;
};

/// How contours are moved aside; mm, rad.
struct OffsetOptions {
  double distance = 0;   ///< of the tool's axis from the contour
  double chord = 0.01;   ///< between the way and its chords
  double crease = 0;     ///< a contour that turns by less where it cannot be reached is a round one in facets
  double smoothing = 0;  ///< length of the way over which the tool axis is averaged
  double depth = 0;      ///< of the tip under the surface: so deep the chord tolerance holds as well
};

/// `contour` moved to the left by the distance, continuous. Each segment is moved aside in the planes across
/// the tool axis at its ends; what turns little gets a node where both sides meet.
Aside MovedAside(const Contour& contour, const OffsetOptions& options);

}  // namespace millpose
