// SPDX-License-Identifier: GPL-3.0-or-later
// Force on a cutter from what of its edge is in the material (docs/engagement.md).
#pragma once

#include <functional>
#include <vector>

#include "toolpath/engagement/edge.hpp"

namespace millpose {

/// Where a cutter stands and moves to. Unit vectors; `axis` from tip to holder, `feed` not along it. The feed
/// need not lie across the axis: where the cutter leans, it does not.
struct CutterStance {
  Eigen::Vector3d tip, feed, axis;
  double feed_per_tooth = 0;  ///< mm along `feed`

  Eigen::Vector3d Across() const { return axis.cross(feed).normalized(); }
};

/// Whether there is material at a place of the edge, before it comes there.
using InMaterial = std::function<bool(const Eigen::Vector3d&)>;

/// A stretch of edge in the material: `slice` from angle `start` to `end` (rad, clockwise seen from the
/// holder, 0 on the left of the feed, 90° ahead).
struct EngagedArc {
  size_t slice = 0;
  double start = 0, end = 0;
};

/// What of the edge removes chips: where it moves out of the cutter's envelope and `in_material` holds. The
/// ends of the arcs are found by bisection (5e-4 rad); arcs shorter than 1/32 of a slice's front may be
/// missed.
std::vector<EngagedArc> EngagedArcs(const std::vector<EdgeSlice>& slices, const CutterStance& stance,
                                    const InMaterial& in_material);

/// Mean force of all teeth on the tool over a revolution (N, in the stance's frame). The chip thickness is
/// feed per tooth · (feed · envelope's normal) (Altintas and Engin, Annals of the CIRP 50, 2001; with a
/// leaning axis: Ozturk and Budak, Machining Science and Technology 11, 2007), the forces Kienzle's.
Eigen::Vector3d MeanForce(const EdgeModel& model, const std::vector<EdgeSlice>& slices,
                          const CutterStance& stance, const std::vector<EngagedArc>& arcs);

/// Largest length of the sum of all teeth's forces over a revolution, N, by `steps` positions.
double PeakForce(const EdgeModel& model, const std::vector<EdgeSlice>& slices, const CutterStance& stance,
                 const std::vector<EngagedArc>& arcs, int steps);

/// Arcs as seen along the feed: intervals of the coordinate to the left (mm from the axis) that some slice
/// cuts, merged, ascending.
std::vector<std::pair<double, double>> CutWidths(const std::vector<EdgeSlice>& slices,
                                                 const std::vector<EngagedArc>& arcs);

}  // namespace millpose
