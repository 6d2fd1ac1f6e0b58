// SPDX-License-Identifier: GPL-3.0-or-later
// What gives way besides the joints, as far as measurements can tell (docs/identification.md).
#pragma once

#include <vector>

#include "machine/identification/identify.hpp"

namespace millpose {

/// A model of what gives way, and how well it foretells poses that it was not fitted to.
struct ComplianceModel {
  std::vector<int> tilting;  ///< links that tilt about both axes across their joint's, in the order of gain
  bool base = false;         ///< the base moves along all three axes
  size_t unknowns = 6;
  double mean_square = 0;  ///< mm², of the displacements of each pose as the others foretell them
  double deviation = 0;    ///< standard deviation of that mean, mm²

  /// IdentifyOptions::beside.
  std::vector<Give> Gives() const;
};

/// Models, each with the one before in it.
struct ComplianceModels {
  std::vector<ComplianceModel> tried;  ///< the joints' springs first
  size_t least = 0;                    ///< foretells best
  size_t chosen = 0;  ///< the first within one standard deviation of the least: the simplest that will do
};

/// Springs in the joints; with tilting of that link more which leaves the least error, link by link; with all
/// of them a base that moves. Every pose is foretold from the others. Models with something that the poses
/// cannot tell apart are left out; the springs alone are tried with fewer than kLeastPosesForModels.
ComplianceModels TryModels(const Arm& arm, const std::vector<LoadCase>& cases,
                           const IdentifyOptions& options);

inline constexpr size_t kLeastPosesForModels = 12;

}  // namespace millpose
