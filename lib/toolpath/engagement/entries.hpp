// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "toolpath/engagement/engagement.hpp"

namespace millpose {

/// Whether material stands under the middle of the cutter where it comes straight down its axis to each of
/// the points `entries` (their numbers, counted through all passes). Precondition: `options` has no stated
/// cut.
std::vector<char> MeetsMaterial(const EngagementOptions& options, const Toolpath& toolpath,
                                const std::vector<size_t>& entries);

}  // namespace millpose
