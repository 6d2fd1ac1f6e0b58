// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/deviations.hpp"

#include "base/rotation.hpp"

namespace millpose {
namespace {

/// TrueLinkFrames() where the arm's own joints are at `angles`.
LinkPoses FramesWith(const Arm& arm, const ArmDeviations& deviations, const Joints& angles) {
  const LinkPoses nominal = LinkFrames(arm, angles);
  LinkPoses frames = nominal;
  for (size_t i = 1; i < frames.size(); ++i)
    frames[i] = frames[i - 1] * DeviationOf(deviations, i - 1) *
                (nominal[i - 1].inverse(Eigen::Isometry) * nominal[i]);
  return frames;
}

Pose FlangeWith(const Arm& arm, const ArmDeviations& deviations, const Joints& angles) {
  return FramesWith(arm, deviations, angles).back() * DeviationOf(deviations, 6);
}

/// The arm's own angles that bring it to X_BF.
std::optional<Joints> AnglesNear(const Arm& arm, const ArmDeviations& deviations, const Pose& X_BF,
                                 int branch, const Joints& near) {
  constexpr int kMost = 20;         // steps; each leaves some thousandth of what was off
  constexpr double kExact = 1e-13;  // rad
  std::optional<Joints> q = InverseNear(arm, X_BF, branch, near);
  for (int step = 0; q && step < kMost; ++step) {
    const Pose off = X_BF * FlangeWith(arm, deviations, *q).inverse(Eigen::Isometry);
    const std::optional<Joints> next = InverseNear(arm, off * ForwardFlange(arm, *q), branch, *q);
    if (!next) return std::nullopt;
    const double moved = (*next - *q).cwiseAbs().maxCoeff();
    q = next;
    if (moved < kExact) return q;
  }
  // What rounding alone keeps moving is there.
  if (q && (FlangeWith(arm, deviations, *q).translation() - X_BF.translation()).norm() < 1e-6) return q;
  return std::nullopt;
}

}  // namespace

Pose DeviationOf(const ArmDeviations& deviations, size_t frame) {
  Pose moved = Pose::Identity();
  moved.translation() = deviations.shift[frame];
  if (const double angle = deviations.turn[frame].norm(); angle > 0)
    moved.linear() = RotationAbout(deviations.turn[frame] / angle, angle);
  return moved;
}

LinkPoses TrueLinkFrames(const Arm& arm, const ArmDeviations& deviations, const Joints& q) {
  return FramesWith(arm, deviations, deviations.law.At(q));
}

Pose TrueFlange(const Arm& arm, const ArmDeviations& deviations, const Joints& q) {
  return FlangeWith(arm, deviations, deviations.law.At(q));
}

std::optional<Joints> TrueInverseNear(const Arm& arm, const ArmDeviations& deviations, const Pose& X_BF,
                                      int branch, const Joints& near) {
  const std::optional<Joints> angles = AnglesNear(arm, deviations, X_BF, branch, deviations.law.At(near));
  return angles ? std::optional(deviations.law.Invert(*angles)) : std::nullopt;
}

}  // namespace millpose
