// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/krl/krl_options.hpp"

#include "base/trig.hpp"
#include "program/pose_text.hpp"

namespace millpose {

Pose KrlRobroot(const KrlOptions& options) { return MakePose(options.robroot.value_or(PoseSettings{})); }

Pose KrlBase(const KrlOptions& options) {
  Pose robroot = KrlRobroot(options);
  if (!options.ersysroot) return robroot;
  const KrlRail& rail = *options.ersysroot;
  Pose carriage = Pose::Identity();
  carriage.translation() =
      options.external_axes.at(static_cast<size_t>(rail.axis) - 1) * DirectionOf(rail.direction);
  return MakePose(rail.pose) * carriage * robroot;
}

double KrlTilt(const KrlOptions& options, const Pose& X_WB) {
  const Eigen::Vector3d up = X_WB.linear().row(2);
  const Eigen::Vector3d believed = KrlBase(options).linear().row(2);
  return Atan2(up.cross(believed).norm(), up.dot(believed));
}

}  // namespace millpose
