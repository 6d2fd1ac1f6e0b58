// SPDX-License-Identifier: GPL-3.0-or-later
// Ladder graphs so small that every sequence can be looked at.
#pragma once

#include <cmath>
#include <limits>

#include "base/random.hpp"
#include "base/units.hpp"
#include "planning/ladder/ladder_search.hpp"

namespace millpose {

inline std::vector<Layer> SmallLayers(RandomStream& stream, int count) {
  std::vector<Layer> layers(static_cast<size_t>(count));
  for (Layer& layer : layers) {
    const int nodes = 1 + stream.Below(5);
    for (int k = 0; k < nodes; ++k) {
      Joints q;
      for (int j = 0; j < 6; ++j) q[j] = 0.5 * stream.Normal();
      layer.joints.Add(q);
      // Few values, so that many sequences have the same worst.
      layer.objective.push_back(1 + stream.Below(6) + (stream.Below(3) ? 0 : stream.Uniform(0, 1)));
      layer.first.push_back(k);
      layer.freedoms.push_back({static_cast<double>(k)});
      layer.base.push_back(static_cast<size_t>(k));
      layer.genetic.push_back(false);
    }
    for (int branch = 1; branch <= 8; ++branch) layer.lane_begin[static_cast<size_t>(branch)] = layer.size();
    layer.joints.Finish();
  }
  return layers;
}

inline StepRule SmallRule() {
  StepRule rule;
  rule.max_step = Joints::Constant(DegToRad(60));
  rule.motion_weight = 0.3;
  return rule;
}

/// The next choice of a node in each layer, in the order of counting; false after the last.
inline bool NextChoice(std::span<const Layer> layers, std::vector<size_t>& nodes) {
  for (size_t t = 0; t < nodes.size(); ++t) {
    if (++nodes[t] < layers[t].size()) return true;
    nodes[t] = 0;
  }
  return false;
}

/// Objective and motion along a sequence with its breaks, round to the first when closed; +inf where a step
/// is too large.
inline double CostOf(const LadderProblem& problem, const Sequence& sequence) {
  double cost = 0;
  for (size_t t = 0; t < sequence.nodes.size(); ++t) {
    const Layer& layer = problem.layers[t];
    cost += layer.objective[sequence.nodes[t]];
    const size_t next = (t + 1) % sequence.nodes.size();
    if (sequence.break_before[next] || (next == 0 && !sequence.closed)) continue;
    cost += StepCost(problem.rule, layer.joints.At(sequence.nodes[t]),
                     problem.layers[next].joints.At(sequence.nodes[next]));
  }
  return cost;
}

}  // namespace millpose
