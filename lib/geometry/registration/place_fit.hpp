// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/registration/register.hpp"

namespace millpose {

/// A fit of a rigid part, or of one with bending.
struct FittedPlace {
  Registration found;
  /// By the number of modes kept, none first: sum of squares, in stated standard deviations, that least
  /// squares leave on the points that count.
  std::vector<double> squares;
};

/// As Register; with `frame` its modes are fitted too, from the values that they have there. One point at
/// least.
FittedPlace FitPlace(const ProbedPart& part, const std::vector<ProbedPoint>& points,
                     const Eigen::Isometry3d& start, const PartBending* frame, int threads,
                     std::stop_token stop);

}  // namespace millpose
