// SPDX-License-Identifier: GPL-3.0-or-later
// Other ways to lay the same pass.
#pragma once

#include <vector>

#include "toolpath/milling_point.hpp"

namespace millpose {

/// Turns a point round whose pass of that length (mm, a closed pass's whole way) is run from its end.
void ReversePass(double length, MillingPoint& point);

/// An open pass run from its end. What depends on the feed is not worked out anew: the engagement, and the
/// tool axis of a cutter that leans.
Pass RunFromEnd(const Pass& pass);

/// `laid` with the points of `finer` that lie between its points t and t + 1 (of a closed pass also between
/// the last and the first) where `between[t]` is set, save those that would gouge. `finer` holds the points
/// of `laid` and others (ToolpathOptions::parts); where it lacks one, `laid` comes back as it is.
Pass WithPointsBetween(const Pass& laid, const Pass& finer, const std::vector<char>& between);

}  // namespace millpose
