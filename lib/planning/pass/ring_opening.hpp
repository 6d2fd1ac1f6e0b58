// SPDX-License-Identifier: GPL-3.0-or-later
// A closed pass that is left open: it begins at a chosen point, and its end runs on over that beginning.
#pragma once

#include "planning/pass/overlap.hpp"
#include "planning/pass/split_planner.hpp"

namespace millpose {

/// Whether a pass is planned as a ring left open.
bool IsOpenedRing(const Pass& pass);

/// The closed pass that begins with another of its points; arc lengths count from there.
Pass BeginningAt(const Pass& pass, size_t start);

/// Turns the points of a closed pass (none added) so that they begin with point `start`, what is known of
/// them too.
void TurnToBegin(const Pass& turned, size_t start, SplitPoints& own);

/// `ends` for a ring left open: arcs where the job names no leads, since without them its start shows.
PassEnds RingEnds(PassEnds ends);

/// Leads at both ends of a ring left open, `points` with what its splits add, where there are none yet; part
/// of the split with the index `seam`.
void AddRingLeads(const PassEnds& ends, double spacing, int seam, std::vector<SplitPoint>& points);

/// As OverlapChoices, for the place where a ring is opened: its end runs on over its beginning first.
std::vector<OverlapChoice> RingChoices(double length);

}  // namespace millpose
