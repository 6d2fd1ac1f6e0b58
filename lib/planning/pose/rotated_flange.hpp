// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/robot/inverse_block.hpp"

namespace millpose {

/// Of every lane.
SineCosineLanes SinCosOf(const Lanes& angle, InstructionSet set = WidestInstructionSet());

/// Flange poses as the tool turns about its own axis by θ: each entry of X_BF is a + b·cos θ + c·sin θ.
struct RotatedFlange {
  RotatedFlange() = default;
  /// `X_BT`: the tool at θ = 0; `X_TF`: the flange in the tool.
  RotatedFlange(const Pose& X_BT, const Pose& X_TF);
  void Set(const SineCosineLanes& angle, FlangeBlock& out, InstructionSet set = WidestInstructionSet()) const;
  /// One lane alone; the same bits.
  void SetLane(size_t lane, const SineCosineLanes& angle, FlangeBlock& out) const;

 private:
  using Matrix34 = Eigen::Matrix<double, 3, 4>;
  Matrix34 constant_ = Matrix34::Zero(), cosine_ = Matrix34::Zero(), sine_ = Matrix34::Zero();
};

}  // namespace millpose
