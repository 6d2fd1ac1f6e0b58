// SPDX-License-Identifier: GPL-3.0-or-later
// Joints that follow another one, as far as a tracker's readings tell (docs/geometry-identification.md).
#pragma once

#include <vector>

#include "machine/identification/geometry_fit.hpp"

namespace millpose {

/// A fit with couplings, and how well it foretells poses that it did not see.
struct CouplingModel {
  std::vector<JointPair> couplings;          ///< in the order of gain
  std::vector<DeviationEstimate> estimates;  ///< of each factor
  double mean_square = 0;                    ///< mm², of each pose as the others foretell it
  double deviation = 0;                      ///< standard deviation of that mean, mm²
};

/// Models, each with the one before in it.
struct CouplingModels {
  std::vector<CouplingModel> tried;  ///< without couplings first
  size_t least = 0;                  ///< foretells best
  size_t chosen = 0;  ///< the first within one standard deviation of the least: the simplest that will do
};

/// Without couplings, then with that one more which leaves the least error: A3 that follows A2 (a rod or a
/// gear at the foot), A5 that follows A4, A6 that follows A4 or A5 (shafts through a hollow wrist); none that
/// the law knows. `plain`: the fit without them, by the same options.
CouplingModels TryCouplings(const Arm& arm, const std::vector<TrackedPose>& poses,
                            const GeometryFitOptions& options, const GeometryFit& plain);

}  // namespace millpose
