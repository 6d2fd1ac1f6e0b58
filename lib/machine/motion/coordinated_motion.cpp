// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/motion/coordinated_motion.hpp"

#include "machine/robot/position_between.hpp"

namespace millpose {

ExternalPosition CoordinatedMotion::At(double share) const { return PositionBetween(from, to, share); }

Pose CoordinatedMotion::BaseInPart(double share) const {
  const ExternalPosition external = At(share);
  const Pose X_WP_here = mechanism.Moved(Carries::kWorkpiece, external) * X_WP;
  return X_WP_here.inverse(Eigen::Isometry) * mechanism.Moved(Carries::kRobot, external) * X_WB;
}

}  // namespace millpose
