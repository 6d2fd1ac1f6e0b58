// SPDX-License-Identifier: GPL-3.0-or-later
// How an arm's own geometry differs from its sheet (docs/arm-deviations.md).
#pragma once

#include <array>

#include "machine/robot/kinematics.hpp"

namespace millpose {

/// By how much the frames of LinkFrames() stand elsewhere, each in its own axes: 0 base, 1..6 after joint i,
/// 6 the flange. Whatever hangs behind a frame goes with it. A turn about a joint's own axis is its offset.
struct ArmDeviations {
  std::array<Eigen::Vector3d, 7> shift{};  ///< mm
  std::array<Eigen::Vector3d, 7> turn{};   ///< rotation vector, rad

  ArmDeviations() {
    shift.fill(Eigen::Vector3d::Zero());
    turn.fill(Eigen::Vector3d::Zero());
  }
};

/// X_BF of the arm as it is, B its nominal base frame: D0·L1·D1·L2·…·L6·D6 with L the nominal steps from
/// frame to frame and D = (turn, shift) of each. ForwardFlange() to the last bits where all are zero.
Pose TrueFlange(const Arm& arm, const ArmDeviations& deviations, const Joints& q);

}  // namespace millpose
