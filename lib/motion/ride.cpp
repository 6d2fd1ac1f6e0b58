// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/ride.hpp"

namespace millpose {

ExternalPosition Ride::At(double share) const {
  ExternalPosition external(from.size());
  for (size_t i = 0; i < from.size(); ++i) external[i] = from[i] + share * (to[i] - from[i]);
  return external;
}

Pose Ride::BaseInPart(double share) const {
  const ExternalPosition external = At(share);
  const Pose X_WP_here = mechanism.Moved(Carries::kWorkpiece, external) * X_WP;
  return X_WP_here.inverse(Eigen::Isometry) * mechanism.Moved(Carries::kRobot, external) * X_WB;
}

}  // namespace millpose
