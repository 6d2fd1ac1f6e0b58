// SPDX-License-Identifier: GPL-3.0-or-later
// Where a pass has to be split, its parts share some of the way: what the tool cuts up to the split is cut
// again by the next part, which comes in along its lead.
#pragma once

#include <span>

#include "toolpath/milling_point.hpp"
#include "toolpath/pass_ends.hpp"

namespace millpose {

/// A way for two parts to share a split.
struct OverlapChoice {
  enum class By : uint8_t {
    kLater,    ///< the part after the split begins earlier
    kEarlier,  ///< the part before it goes on
    kNone,     ///< neither could be planned: the step at the split is not cut
  };
  By by = By::kLater;
  double length = 0;  ///< mm; at least up to the next point
};

/// A split of a pass after its point `after`; after the last point of a closed pass it is where it ends.
struct Split {
  size_t after = 0;
  OverlapChoice overlap;
};

/// A point to be planned: one of the pass's own, or one that a split adds.
struct SplitPoint {
  MillingPoint point;
  size_t source = 0;          ///< the point of the pass that it is or, with another pose, repeats or leads to
  int added_by = -1;          ///< index of the split; −1 for the pass's own points
  bool break_before = false;  ///< the tool is lifted before it
};

/// The points of a pass with what its splits (in ascending order) add: repeated points become leads, those of
/// `ends` (without overrun) follow beyond them. Arc lengths go on evenly within each part; a split closed
/// pass is none any more. `spacing`: mm, of the leads' points.
std::vector<SplitPoint> WithOverlaps(const Pass& pass, std::span<const Split> splits, const PassEnds& ends,
                                     double spacing);

/// The lead of `ends` (without overrun) beyond a point with which a part begins (`step` −1) or ends (1),
/// outwards from it.
std::vector<SplitPoint> LeadBeyond(const SplitPoint& end, int step, const PassEnds& ends, double spacing);

/// What to try for a split, in this order, when up to `length` (mm) is asked for; the last is kNone.
std::vector<OverlapChoice> OverlapChoices(double length);

}  // namespace millpose
