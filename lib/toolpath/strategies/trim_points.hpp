// SPDX-License-Identifier: GPL-3.0-or-later
// The milling points along a trim's way.
#pragma once

#include "toolpath/strategies/trim_offset.hpp"

namespace millpose {

/// A place of the way; the tip lies `depth` under the surface along the axis.
struct TrimStop {
  OffsetNode node;
  double depth = 0;
  double feed = 0;    ///< mm/s up to here
  bool back = false;  ///< the way up to here leads back, over the part
};

/// The way from stop to stop, straight between them. Those up to `lead_in` are the lead-in, those from
/// `lead_out` on the lead-out.
struct TrimStops {
  std::vector<TrimStop> stops;
  size_t lead_in = 0, lead_out = 0;
};

/// Milling points along the stops, at most `options.spacing` apart. What a point is depends on its place
/// between two stops alone, so that finer passes hold the points of the coarser.
Pass PointsAlong(const Trim& trim, const ToolpathOptions& options, const TrimStops& way);

}  // namespace millpose
