// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/free_optimum.hpp"

#include "planning/ladder/table_layer.hpp"

namespace millpose {
namespace {

/// The least of the nodes of layer t that is free; `chosen` is.
size_t LeastFree(size_t t, size_t chosen, CandidateGraph& graph, PassCheckers& checkers) {
  const Layer& layer = graph.layer(t);
  // The least on top, of equals the first.
  std::vector<std::pair<double, size_t>> better;
  for (size_t node = 0; node < layer.size(); ++node)
    if (layer.objective[node] < layer.objective[chosen]) better.emplace_back(layer.objective[node], node);
  std::make_heap(better.begin(), better.end(), std::greater<>());
  while (!better.empty()) {
    const size_t node = better.front().second;
    if (graph.IsFree(checkers, t, node)) return node;
    std::pop_heap(better.begin(), better.end(), std::greater<>());
    better.pop_back();
  }
  return chosen;
}

}  // namespace

std::vector<FreeOptimum> FindFreeOptima(std::span<const PointOptimum> optima, const Sequence& sequence,
                                        CandidateGraph& graph) {
  std::vector<FreeOptimum> found(graph.size());
  graph.InParallel(graph.size(), [&](PassCheckers& checkers, size_t t) {
    const size_t chosen = sequence.nodes[t];
    if (chosen == kNoNode) return;
    const Layer& layer = graph.layer(t);
    const PointOptimum& own = optima[t];
    FreeOptimum& best = found[t];
    if (own.found && own.objective <= layer.objective[chosen]) {
      const bool gouges = graph.checks().gouges.At(own.q) > 0;
      if (!gouges) best.barred = graph.Meets(checkers, t, own.freedoms, own.q);
      if (!gouges && !best.barred) {
        best = {true, own.objective, own.freedoms, own.branch, {}};
        return;
      }
    }
    const size_t node = LeastFree(t, chosen, graph, checkers);
    best.found = true;
    best.objective = layer.objective[node];
    best.freedoms = FreedomsOf(layer, node);
    best.branch = layer.BranchOf(node);
  });
  return found;
}

}  // namespace millpose
