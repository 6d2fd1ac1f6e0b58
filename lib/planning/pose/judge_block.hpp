// SPDX-License-Identifier: GPL-3.0-or-later
// The admissible predicate, for a block of poses, one per lane: whatever says that a pose may or may not be
// used for its limits, singularities or dexterity asks here (interference is not part of it).
#pragma once

#include "planning/pose/scorer.hpp"

namespace millpose {

/// The poses of one arm branch with one of its two wrists.
struct CheckedWrist {
  std::array<Lanes, 6> q;  ///< rad; within the limits where full revolutions bring it there, else principal
  Lanes shortfall;         ///< as in Candidate
  std::array<Infeasibility, kLanes> obstacle;  ///< kUnreachable, kLimit, kSingular or kNone
};
struct CheckedBranch {
  CheckedWrist unflipped, flipped;
};

/// Puts the angles of both wrists within the limits of `problem` where full revolutions can, and says what
/// each pose misses. Limits come before singularities: a pose that misses both is kLimit.
void CheckAdmissible(const PoseProblem& problem, const FlangeBlock& flange, const ArmBranchBlock& branch,
                     CheckedBranch& out, InstructionSet set = WidestInstructionSet());

}  // namespace millpose
