// SPDX-License-Identifier: GPL-3.0-or-later
// Ladder graphs without meaning, and what is done to them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "base/random.hpp"
#include "base/units.hpp"
#include "planning/ladder/ladder_search.hpp"

namespace millpose {

/// Layers without meaning: few branches, joints near one another, so that ties, breaks and detours happen.
inline std::vector<Layer> RandomLayers(RandomStream& stream, int count, int most_nodes, double spread) {
  std::vector<Layer> layers(count);
  for (Layer& layer : layers) {
    const int nodes = stream.Below(most_nodes + 1);
    std::vector<std::pair<int, double>> places;
    for (int k = 0; k < nodes; ++k) places.emplace_back(stream.Below(2), stream.Uniform(-kPi, kPi));
    std::sort(places.begin(), places.end());
    for (const auto& [branch, value] : places) {
      Joints q;
      for (int j = 0; j < 6; ++j) q[j] = spread * stream.Normal() + (stream.Below(2) ? 2 * kPi : 0.0);
      layer.joints.Add(q);
      layer.objective.push_back(stream.Below(12) == 0 ? std::numeric_limits<double>::infinity()
                                                      : stream.Uniform(1, 2));
      layer.freedoms.push_back({value});
      layer.first.push_back(value);
      layer.base.push_back(layer.base.size());
      layer.genetic.push_back(false);
      for (int later = branch + 1; later <= 8; ++later) layer.lane_begin[later] = layer.size();
    }
    layer.joints.Finish();
  }
  return layers;
}

inline StepRule Rule(double step_deg, double weight = 1e-5) {
  StepRule rule;
  rule.max_step = Joints::Constant(DegToRad(step_deg));
  rule.motion_weight = weight;
  return rule;
}

/// Prunes a few nodes and edges, as interference does.
inline void BlockSome(RandomStream& stream, std::vector<Layer>& layers, std::vector<BlockedEdges>& blocked,
                      std::vector<uint64_t>& versions) {
  for (int k = 0; k < 3; ++k) {
    const auto t = static_cast<size_t>(stream.Below(static_cast<int>(layers.size())));
    if (layers[t].size() == 0) continue;
    const auto node = static_cast<size_t>(stream.Below(static_cast<int>(layers[t].size())));
    ++versions[t];
    if (stream.Below(3) > 0) {
      layers[t].objective[node] = std::numeric_limits<double>::infinity();
    } else if (const size_t next = layers[(t + 1) % layers.size()].size(); next > 0) {
      blocked[t].insert({node, static_cast<size_t>(stream.Below(static_cast<int>(next)))});
    }
  }
}

inline void ExpectSame(const Sequence& a, const Sequence& b) {
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.break_before, b.break_before);
  EXPECT_EQ(a.cost, b.cost);
}

}  // namespace millpose
