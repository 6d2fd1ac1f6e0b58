// SPDX-License-Identifier: GPL-3.0-or-later
// Whether measurements and what was identified from them can be true of a milling arm.
#pragma once

#include <string>
#include <vector>

#include "machine/identification/identify.hpp"

namespace millpose {

struct Plausibility {
  std::vector<std::string> findings;  ///< what cannot be true, or does not fit together; with the reason
  std::vector<std::string> warnings;  ///< what is unusual
  std::string residual;               ///< what the residual means, one sentence; empty without one
  bool usable = true;                 ///< no reading and no stiffness is beyond belief
};

/// Looks at the readings alone (units: metres, kilonewtons, poses with different ones; those cancel out in
/// the stiffness), at each joint's stiffness, and at the residual against the deviation that was stated.
Plausibility JudgeIdentification(const Arm& arm, const std::vector<LoadCase>& cases,
                                 const IdentifyOptions& options, const Identification& found);

}  // namespace millpose
