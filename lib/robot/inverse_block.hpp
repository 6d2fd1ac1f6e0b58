// SPDX-License-Identifier: GPL-3.0-or-later
// Inverse kinematics of a block of flange poses, one per lane: the hot loop of every search.
#pragma once

#include <array>

#include "base/lanes.hpp"
#include "robot/kinematics.hpp"

namespace millpose {

struct SineCosineLanes {
  Lanes sin, cos;
};

/// Poses X_BF of a block: columns of the rotation and the origin, mm.
struct FlangeBlock {
  std::array<Lanes, 3> x, y, z, p;

  void Set(int lane, const Pose& X_BF);
};

/// One arm branch (status bits 0 and 1) of a block, with the wrist unflipped (bit 2 clear: sin q5 ≥ 0).
/// Everything is finite; where `reached` is 0 it means nothing.
struct ArmBranchBlock {
  std::array<SineCosineLanes, 6> q;  ///< sines and cosines of the inner angles
  Lanes reached;                     ///< 1 or 0
  Lanes wrist;                       ///< sin q5 ≥ 0
  Lanes elbow;                       ///< |sin| of the angle between upper arm and forearm
  Lanes shoulder;                    ///< distance of the wrist centre from axis 1, mm
};

/// Entry b holds the branches b and b + 4. Same formulas and bits as Inverse().
using ArmBranches = std::array<ArmBranchBlock, 4>;
void InverseBlock(const Arm& arm, const FlangeBlock& flange, ArmBranches& out,
                  InstructionSet set = WidestInstructionSet());

/// Outer angles, rad, principal, of both wrists of an arm branch; the same bits as Inverse() gives.
struct AnglesBlock {
  std::array<Lanes, 6> unflipped;      ///< bit 2 clear
  Lanes flipped4, flipped5, flipped6;  ///< A4..A6 with bit 2 set; A1..A3 are those of `unflipped`
};
void AnglesOfBranch(const Arm& arm, const ArmBranchBlock& branch, AnglesBlock& out,
                    InstructionSet set = WidestInstructionSet());

}  // namespace millpose
