// SPDX-License-Identifier: GPL-3.0-or-later
// What interference alone costs: the best candidate of each point that meets nothing.
#pragma once

#include "planning/pass/candidate_graph.hpp"

namespace millpose {

/// The best candidate of a point that is free of interference.
struct FreeOptimum {
  bool found = false;
  double objective = 0;
  FreedomValues freedoms;
  int branch = 0;
  std::optional<ContactCandidate> barred;  ///< what the point's own optimum meets; empty when that is free
};

/// Of every layer that `sequence`, a free one, takes a node of: the point's own optimum (`optima`, one per
/// layer) where it is free, else the least of the layer's nodes that is. Candidates are checked one after the
/// other from the least on, those known from the search not again, and none beyond the sequence's own node.
std::vector<FreeOptimum> FindFreeOptima(std::span<const PointOptimum> optima, const Sequence& sequence,
                                        CandidateGraph& graph);

}  // namespace millpose
