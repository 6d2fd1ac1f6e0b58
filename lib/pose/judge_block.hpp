// SPDX-License-Identifier: GPL-3.0-or-later
// The admissible predicate for a block of poses, one per lane.
#pragma once

#include "pose/scorer.hpp"

namespace millpose {

/// Puts the principal angles of both wrists of an arm branch within the bounds where full revolutions can,
/// and says by how much limits and distances to singularities are missed.
struct JudgedWrist {
  std::array<Lanes, 6> q;  ///< rad
  Lanes limit;             ///< rad missed, summed over the joints; 0 within
};
struct JudgedBranch {
  JudgedWrist unflipped, flipped;
  Lanes singular;  ///< missed of the least sines and (in m) of the least distance
};
void Judge(const AdmissibleBounds& bounds, const ArmBranchBlock& branch, const AnglesBlock& angles,
           JudgedBranch& out, InstructionSet set = WidestInstructionSet());

}  // namespace millpose
