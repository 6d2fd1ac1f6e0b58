// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/pose/scorer.hpp"

namespace millpose {

/// The candidates on `branch` where freedom `dimension` takes each of `values`, the others staying as they
/// are.
std::array<Candidate, kLanes> ScoreAlong(const PointScorer& scorer, const FreedomValues& freedoms,
                                         size_t dimension, const std::array<double, kLanes>& values,
                                         int branch);

}  // namespace millpose
