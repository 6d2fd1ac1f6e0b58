// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/pose/scorer.hpp"

namespace millpose {

/// The last admissible value of freedom `dimension` on `branch` on the way from `inside` (admissible) to the
/// value `outside` (not admissible), within `tolerance`: section into kLanes + 1 parts. Adds what it spends
/// to `evaluations`.
double IntervalEnd(const PointScorer& scorer, const FreedomValues& inside, size_t dimension, int branch,
                   double outside, double tolerance, int& evaluations);

}  // namespace millpose
