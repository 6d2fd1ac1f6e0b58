// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/layer_verdicts.hpp"

namespace millpose {

AxisVerdicts LayerVerdicts(const CandidateGraph& graph, size_t t) {
  using Verdict = CandidateGraph::Verdict;
  const Layer& layer = graph.layer(t);
  AxisVerdicts verdicts(size_t{8} * kAxisRotations, kVerdictUnknown);
  std::vector<double> nearest(verdicts.size(), kAxisStep);
  for (int branch = 0; branch < 8; ++branch) {
    for (size_t node = layer.lane_begin[branch]; node < layer.lane_begin[branch + 1]; ++node) {
      const Verdict verdict = graph.VerdictOf(t, node);
      const int pair = graph.PairOf(t, node);
      // Taken for a motion's sake: of itself nothing is known that the search has kept.
      if (verdict == Verdict::kUnknown || (verdict == Verdict::kBlocked && pair < 0)) continue;
      const AxisCell cell = AxisCellOf(layer.first[node]);
      const size_t at = static_cast<size_t>(branch) * kAxisRotations + static_cast<size_t>(cell.index);
      if (cell.off >= nearest[at]) continue;
      nearest[at] = cell.off;
      verdicts[at] = pair >= 0 ? kVerdictPair + pair : kVerdictFree;
    }
  }
  return verdicts;
}

}  // namespace millpose
