// SPDX-License-Identifier: GPL-3.0-or-later
// What a drill takes off on its way down (docs/drill-and-trim.md).
#pragma once

#include "toolpath/engagement/engagement.hpp"

namespace millpose {

/// SetEngagement() for `options.drill`: the lips cut where the tip goes deeper than it was in its pass. Where
/// `options.stock` says nothing, material fills what the points' own cut says, and points without that keep
/// what they have. Engagement's width is the diameter that is cut, its depth a_p = (D − d)/2.
void SetDrilledEngagement(const EngagementOptions& options, int threads, const std::stop_token& stop,
                          Toolpath& toolpath, const std::vector<std::vector<char>>& of);

/// HeaviestCut() for `options.drill`.
CuttingForce HeaviestDrilledCut(const EngagementOptions& options, const Toolpath& toolpath);

}  // namespace millpose
