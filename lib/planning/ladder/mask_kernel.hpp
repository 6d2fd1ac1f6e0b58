// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "planning/ladder/edge_kernel.hpp"

namespace millpose {

/// One bit for each of 64 sets of nodes.
using Mask = uint64_t;

/// From which sets the nodes of a layer are reached, padded like JointRows, and some node of each block.
struct MaskRow {
  explicit MaskRow(std::span<const Mask> of_nodes) { Set(of_nodes); }
  void Set(std::span<const Mask> of_nodes);
  /// Whether one of the nodes first..last−1 is reached from any.
  bool Any(size_t first, size_t last) const;

  std::vector<Mask> masks, of_blocks;
};

/// Neighbouring nodes of a layer, those of a block of JointRows, for which that is asked together.
struct MaskTargets {
  const JointRows* nodes = nullptr;
  size_t begin = 0;                            ///< of the block
  std::array<size_t, kBlock> first{}, last{};  ///< of node begin + l: it may come from first..last−1
  std::array<Mask, kBlock> reached{};          ///< added to
};

/// Adds the masks of all nodes of the layer before that are within a step. What adds nothing is passed over
/// for all targets at once.
void ReachBlock(const StepRule& rule, const JointRows& from, const MaskRow& row, MaskTargets& targets);

}  // namespace millpose
