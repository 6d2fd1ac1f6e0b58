// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/robot/mechanism.hpp"

namespace millpose {

/// How the robot's base moves as seen from the part while the external axes go evenly from one position to
/// another, all with the same share of their way at any time (docs/external-axes.md).
struct CoordinatedMotion {
  Mechanism mechanism;
  Pose X_WB = Pose::Identity(), X_WP = Pose::Identity();  ///< with all external axes at 0
  ExternalPosition from, to;                              ///< one value for each axis

  ExternalPosition At(double share) const;  ///< 0..1 of the way
  Pose BaseInPart(double share) const;      ///< X_PB there
};

}  // namespace millpose
