// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/ladder/edge_kernel.hpp"

namespace millpose {

/// Neighbouring nodes of a layer, those of a block of JointRows, for which the best predecessors are looked
/// for together.
struct TargetBlock {
  const JointRows* nodes = nullptr;
  size_t begin = 0;                            ///< of the block
  unsigned wanted = 0;                         ///< bit l: node begin + l
  std::array<size_t, kBlock> first{}, last{};  ///< of node begin + l: it may come from first..last−1
  std::array<BestPredecessor, kBlock> best;
};

/// For every wanted node what RelaxFrom finds, bit by bit: what is passed over is passed over for all of them
/// at once. `guess`: a predecessor that may be as good as any; the search goes outward from there.
void RelaxBlock(const StepRule& rule, const JointRows& from, const CostRow& row, size_t guess,
                TargetBlock& targets);

}  // namespace millpose
