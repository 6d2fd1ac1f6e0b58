// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/pass/segment_check.hpp"
#include "planning/smoothing/smoothing.hpp"

namespace millpose {

/// Smooths a piece that is free of interference so that it stays free. `options` as for SmoothPath, its
/// `before` is set here. Every point keeps to a range about where it was; what interferes at a smoothed point
/// or between two is bounded there, between that place and the free one, and the piece is smoothed again
/// beside it. Ranges only shrink and always hold the path as it was. Leaves the path alone where it does not
/// become smoother.
void SmoothFree(std::span<const PointScorer> scorers, std::span<const MillingPoint> points,
                SmoothOptions options, SegmentChecker& checker, std::span<PathNode> path);

}  // namespace millpose
