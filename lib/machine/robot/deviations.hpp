// SPDX-License-Identifier: GPL-3.0-or-later
// How an arm differs from its sheet: its geometry (docs/arm-deviations.md) and what its joints do
// (docs/gear-table.md).
#pragma once

#include <array>
#include <optional>

#include "machine/robot/joint_law.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {

/// By how much the frames of LinkFrames() stand elsewhere, each in its own axes: 0 base, 1..6 after joint i,
/// 6 the flange. Whatever hangs behind a frame goes with it. A turn about a joint's own axis is its offset.
struct ArmDeviations {
  static std::array<Eigen::Vector3d, 7> None() {
    std::array<Eigen::Vector3d, 7> none;
    none.fill(Eigen::Vector3d::Zero());
    return none;
  }

  std::array<Eigen::Vector3d, 7> shift = None();  ///< mm
  std::array<Eigen::Vector3d, 7> turn = None();   ///< rotation vector, rad
  JointLaw law = {};                              ///< of the joints' angles
};

/// LinkFrames() of the arm as it is where its controller has the joints at `q`, each without its own
/// deviation: like there, joint i turns about an axis of frame i. What hangs on frame i hangs on
/// DeviationOf(deviations, i) in it.
LinkPoses TrueLinkFrames(const Arm& arm, const ArmDeviations& deviations, const Joints& q);

/// D_i = (turn, shift) of frame i.
Pose DeviationOf(const ArmDeviations& deviations, size_t frame);

/// X_BF of the arm as it is, B its nominal base frame: D0·L1·D1·L2·…·L6·D6 with L the nominal steps from
/// frame to frame, at the angles that the law makes of `q`, and D = (turn, shift) of each. ForwardFlange()
/// to the last bits where all are zero.
Pose TrueFlange(const Arm& arm, const ArmDeviations& deviations, const Joints& q);

/// The controller's joint angles that bring the arm as it is to X_BF, on branch `branch` of the nominal arm
/// and nearest to `near`; limits not looked at. The arm's own are then law.At() of them. Empty where that
/// branch has none, or beside a singularity, where small deviations ask for large turns.
std::optional<Joints> TrueInverseNear(const Arm& arm, const ArmDeviations& deviations, const Pose& X_BF,
                                      int branch, const Joints& near);

}  // namespace millpose
