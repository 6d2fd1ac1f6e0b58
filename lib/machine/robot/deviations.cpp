// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/deviations.hpp"

#include "base/rotation.hpp"

namespace millpose {

Pose TrueFlange(const Arm& arm, const ArmDeviations& deviations, const Joints& q) {
  const std::array<Pose, 7> frames = LinkFrames(arm, q);
  Pose X = Pose::Identity();
  for (size_t i = 0; i < frames.size(); ++i) {
    X = X * (i == 0 ? frames[0] : frames[i - 1].inverse(Eigen::Isometry) * frames[i]);
    Pose moved = Pose::Identity();
    moved.translation() = deviations.shift[i];
    if (const double angle = deviations.turn[i].norm(); angle > 0)
      moved.linear() = RotationAbout(deviations.turn[i] / angle, angle);
    X = X * moved;
  }
  return X;
}

}  // namespace millpose
