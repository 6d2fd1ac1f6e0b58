// SPDX-License-Identifier: GPL-3.0-or-later
// Where a pass is lifted because that pays, and where a ring is opened: sequences free of interference.
#pragma once

#include "planning/ladder/lifted_search.hpp"
#include "planning/pass/overlap.hpp"
#include "planning/pass/segment_planner.hpp"

namespace millpose {

struct FoundLifts {
  std::vector<size_t> before;  ///< points before which the tool is lifted, ascending
  long long poses_checked = 0;
};

/// Where an open pass, `points` of `context`, is worth being lifted: the best sequence that is free of
/// interference (LiftedSearch::Open), splits that it has kept. Only between two points of the pass itself,
/// and never so that a single point is left at an end of a part. Places that show a lift least come first
/// (IsPlainPlace): they are taken where they give at least nine tenths of what the best places give.
FoundLifts FindLifts(const PassContext& context, std::span<const SplitPoint> points, const LiftPrice& price);

/// Whether a lift between two neighbouring points shows little: at the border of a region, across an edge of
/// the surface, or where the cutter is in the air.
bool IsPlainPlace(const MillingPoint& a, const MillingPoint& b);

/// The point with which a closed pass begins when it is opened where that costs least, lifts at `price`
/// counted; free of interference (LiftedSearch::Round). Where a point cannot be planned at all: the one after
/// it.
FoundLifts FindRingStart(const PassContext& context, const LiftPrice& price);

}  // namespace millpose
