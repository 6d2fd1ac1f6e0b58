// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/deviations.hpp"

#include "base/rotation.hpp"

namespace millpose {

Pose DeviationOf(const ArmDeviations& deviations, size_t frame) {
  Pose moved = Pose::Identity();
  moved.translation() = deviations.shift[frame];
  if (const double angle = deviations.turn[frame].norm(); angle > 0)
    moved.linear() = RotationAbout(deviations.turn[frame] / angle, angle);
  return moved;
}

std::array<Pose, 7> TrueLinkFrames(const Arm& arm, const ArmDeviations& deviations, const Joints& q) {
  const std::array<Pose, 7> nominal = LinkFrames(arm, q);
  std::array<Pose, 7> frames = nominal;
  for (size_t i = 1; i < frames.size(); ++i)
    frames[i] = frames[i - 1] * DeviationOf(deviations, i - 1) *
                (nominal[i - 1].inverse(Eigen::Isometry) * nominal[i]);
  return frames;
}

Pose TrueFlange(const Arm& arm, const ArmDeviations& deviations, const Joints& q) {
  return TrueLinkFrames(arm, deviations, q).back() * DeviationOf(deviations, 6);
}

std::optional<Joints> TrueInverseNear(const Arm& arm, const ArmDeviations& deviations, const Pose& X_BF,
                                      int branch, const Joints& near) {
  constexpr int kMost = 20;         // steps; each leaves some thousandth of what was off
  constexpr double kExact = 1e-13;  // rad
  std::optional<Joints> q = InverseNear(arm, X_BF, branch, near);
  for (int step = 0; q && step < kMost; ++step) {
    const Pose off = X_BF * TrueFlange(arm, deviations, *q).inverse(Eigen::Isometry);
    const std::optional<Joints> next = InverseNear(arm, off * ForwardFlange(arm, *q), branch, *q);
    if (!next) return std::nullopt;
    const double moved = (*next - *q).cwiseAbs().maxCoeff();
    q = next;
    if (moved < kExact) return q;
  }
  // What rounding alone keeps moving is there.
  if (q && (TrueFlange(arm, deviations, *q).translation() - X_BF.translation()).norm() < 1e-6) return q;
  return std::nullopt;
}

}  // namespace millpose
