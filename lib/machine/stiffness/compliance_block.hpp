// SPDX-License-Identifier: GPL-3.0-or-later
// Compliance and dexterity of a block of poses, one per lane, from the sines and cosines that InverseBlock
// gives. Flipping a spherical wrist only negates columns of the Jacobian, so both branches that an entry
// stands for share all that is here.
#pragma once

#include "machine/robot/inverse_block.hpp"

namespace millpose {

/// Linear compliance c of a block, mm/N, base frame, symmetric.
struct ComplianceBlock {
  Lanes xx, yy, zz, xy, xz, yz;
};

/// c at the point `p_FT` (mm, in F): the sum of v·vᵀ/k over the six joints, with v the point's velocity per
/// joint speed (Chen 2021 eq. 9, top left block). Finite; without meaning where the branch is not reached.
void LinearCompliance(const Arm& arm, const FlangeBlock& flange, const ArmBranchBlock& branch,
                      const Eigen::Vector3d& p_FT, ComplianceBlock& out,
                      InstructionSet set = WidestInstructionSet());

/// Dexterity() at `p_FT`; 0 where the Jacobian is singular, never NaN.
void DexterityOfBlock(const Arm& arm, const FlangeBlock& flange, const ArmBranchBlock& branch,
                      const Eigen::Vector3d& p_FT, double characteristic_length, Lanes& out,
                      InstructionSet set = WidestInstructionSet());

}  // namespace millpose
