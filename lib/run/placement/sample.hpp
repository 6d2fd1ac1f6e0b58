// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/milling_point.hpp"
#include "toolpath/path_section.hpp"

namespace millpose {

/// About `count` of a tool path's cut points that can be milled, or all where it has no more: of passes
/// evenly over the path, of each at least three (ends and middle) as far as it has them.
Toolpath SampleOf(const Toolpath& toolpath, size_t count);

/// What of a laid path lies in a share, by its points: a place is scored by them, and planned with passes
/// that are cut at the planes (ClipToSection).
Toolpath Shared(const Toolpath& toolpath, const PathSection& share);

}  // namespace millpose
