// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/robot/inverse_block.hpp"

namespace millpose {

/// InverseBlock of the entries in `entries` (bit b: entry b) alone, bit by bit the same; others stay as they
/// are. A shoulder that none of them has is not solved.
void InverseEntries(const Arm& arm, const FlangeBlock& flange, unsigned entries, ArmBranches& out,
                    InstructionSet set = WidestInstructionSet());

}  // namespace millpose
