// SPDX-License-Identifier: GPL-3.0-or-later
// Inverse kinematics of a block of flange poses, one per lane: the hot loop of every search.
#pragma once

#include <array>

#include "base/lanes.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {

struct SineCosineLanes {
  Lanes sin, cos;
};

/// Poses X_BF of a block: columns of the rotation and the origin, mm.
struct FlangeBlock {
  std::array<Lanes, 3> x, y, z, p;

  void Set(int lane, const Pose& X_BF);
};

/// Solutions of a block. Everything is finite; where `reached` is 0 it means nothing.
struct ArmBranchBlock {
  std::array<SineCosineLanes, 6> q;  ///< sines and cosines of the inner angles
  Lanes reached;                     ///< 1 or 0
  Lanes wrist;                       ///< |sin q5|
  Lanes elbow;                       ///< |sin| of the angle between upper arm and forearm
  Lanes shoulder;                    ///< distance of the wrist centre from the shoulder's plane, mm
};

/// How many entries of ArmBranches are filled, 4 or 8. Where the wrist is spherical its flip (branch bit 2)
/// changes no more than the last three joints: entry b < 4 holds the unflipped branch b and stands for
/// b + 4 too. With parallel axes entry b holds branch b.
inline int EntryCount(const Arm& arm) { return arm.family == ArmFamily::kSphericalWrist ? 4 : 8; }

/// Same formulas and bits as Inverse(). Entries from EntryCount() on stay as they are.
using ArmBranches = std::array<ArmBranchBlock, 8>;
void InverseBlock(const Arm& arm, const FlangeBlock& flange, ArmBranches& out,
                  InstructionSet set = WidestInstructionSet());

/// Outer angles, rad, principal, of an entry; the same bits as Inverse() gives.
struct AnglesBlock {
  std::array<Lanes, 6> unflipped;      ///< of the branch that the entry holds
  Lanes flipped4, flipped5, flipped6;  ///< A4..A6 of the other wrist that it stands for; A1..A3 are the same
};
void AnglesOfBranch(const Arm& arm, const ArmBranchBlock& branch, AnglesBlock& out,
                    InstructionSet set = WidestInstructionSet());

}  // namespace millpose
