// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>

#include "motion/line.hpp"
#include "path/refine.hpp"

namespace millpose {

/// What the smoothing of a piece goes by.
struct SmoothOptions {
  double objective = 0;      ///< summed along the piece before smoothing
  double loss = 0;           ///< share of it that may be given up
  Joints max_step;           ///< rad, between neighbouring points
  double max_deviation = 0;  ///< mm, of the tip half-way between points (HalfwayDeviation)
  bool closed = false;
  std::stop_token stop;
};

/// Values that the first freedom of a point may take.
struct FreedomRange {
  double lower, upper;
};

/// Shifts the first freedom (the rotation about the tool axis) along a piece so that the mean square of the
/// joint accelerations at the points' feeds (RatesAlong, all joints alike, weighted by time) becomes small:
/// Gauss-Newton on the closed-form inverse, branches and full turns kept, every point admissible and within
/// `ranges`. The objective's sum rises by no more than the share `loss`. Where motions deviate by more than
/// `max_deviation` half-way that is mended, if it can be for the loss allowed, else they may not deviate
/// more than they did. Joint angles of `path` are continuous. Never
/// worsens mean square or deviation beyond the bound. Interference is not looked at.
void SmoothPath(std::span<const PointScorer> scorers, std::span<const MillingPoint> points,
                std::span<const FreedomRange> ranges, const SmoothOptions& options, std::span<PathNode> path);

}  // namespace millpose
