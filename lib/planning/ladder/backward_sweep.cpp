// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/backward_sweep.hpp"

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "planning/ladder/layer_steps.hpp"

namespace millpose {

const ToGo& LeastToGo(const LadderProblem& problem, const NodeMask& counted, BackwardRows& rows) {
  const std::span<const Layer> layers = problem.layers;
  const size_t count = layers.size();
  if (rows.layers.size() != count || rows.first_layer != problem.first_layer || problem.most > rows.most) {
    rows.layers.assign(count, {});
    rows.to_go.assign(count, {});
  }
  const bool all_known = problem.most == rows.most;
  rows.first_layer = problem.first_layer;
  rows.most = problem.most;
  // Of the nodes of the layer after, these counted; the last step is into the first layer.
  std::vector<double> into_first(layers[problem.first_layer].size(), 0.0);
  std::vector<char> changed(into_first.size(), 0);
  bool some_less = false;  // what was left out came back
  CostRow row;
  std::vector<char> wanted;
  std::vector<double> before;
  for (size_t k = count; k-- > 0;) {
    CheckStop(problem.stop);
    const size_t t = (problem.first_layer + k) % count, to = (t + 1) % count;
    const Layer &layer = layers[t], &next = layers[to];
    BackwardRows::OfLayer& own = rows.layers[t];
    const uint64_t version = problem.versions.empty() ? 0 : problem.versions[t];
    const bool holds =
        all_known && !some_less && own.relaxed.size() == layer.size() && own.version == version;
    some_less = false;
    own.version = version;
    if (!holds) own.relaxed.assign(layer.size(), {});
    if (holds && std::ranges::count(changed, 1) == 0) {
      changed.assign(layer.size(), 0);
      continue;
    }
    row.Set(k + 1 == count ? into_first : rows.layers[to].beyond);
    // Costs only rise: what was the cheapest step and still costs the same is so still.
    wanted.assign(layer.size(), 0);
    for (size_t node = 0; node < layer.size(); ++node) {
      const double objective = layer.objective[node];
      BestPredecessor& by = own.relaxed[node];
      if (!(objective <= problem.most) || !std::isfinite(objective) ||
          (!counted.empty() && counted[t][node] == 0))
        by = {};
      else
        wanted[node] = static_cast<char>(!holds || (std::isfinite(by.cost) && changed[by.node] != 0));
      if (wanted[node] != 0) by = {};
    }
    const StepRule rule = problem.RuleFrom(t);
    LayerSteps(next, layer, {rule, BandBetween(problem, rule, layer, next)}).Relax(row, wanted, own.relaxed);
    std::swap(before, own.beyond);
    own.beyond.assign(layer.size(), kInfinity);
    rows.to_go[t].assign(layer.size(), kInfinity);
    for (size_t node = 0; node < layer.size(); ++node) {
      const double rest = own.relaxed[node].cost;
      if (!std::isfinite(rest)) continue;
      rows.to_go[t][node] = rest;
      own.beyond[node] = layer.objective[node] + rest;
    }
    changed.assign(layer.size(), 1);
    if (before.size() != own.beyond.size()) continue;
    for (size_t node = 0; node < layer.size(); ++node) {
      changed[node] = own.beyond[node] != before[node];
      some_less = some_less || own.beyond[node] < before[node];
    }
  }
  return rows.to_go;
}

}  // namespace millpose
