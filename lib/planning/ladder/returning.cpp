// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/returning.hpp"

#include "base/parallel.hpp"

namespace millpose {
namespace {

/// One bit per range.
using Mask = uint64_t;
constexpr size_t kBits = 64;

class MaskSweep {
 public:
  MaskSweep(const LadderProblem& problem, NodeMask counted)
      : problem_(problem), counted_(std::move(counted)) {
    for (size_t t = 0; t < problem.layers.size(); ++t) {
      const Layer& layer = problem.layers[t];
      for (size_t node = 0; node < layer.size(); ++node)
        if (!std::isfinite(layer.objective[node]) || layer.objective[node] > problem.most)
          counted_[t][node] = 0;
    }
  }

  /// Which of at most 64 ranges are come back to.
  Mask Run(std::span<const NodeRange> ranges) const {
    const size_t count = problem_.layers.size();
    std::vector<Mask> start(LayerAt(0).size(), 0);
    for (size_t i = 0; i < ranges.size(); ++i)
      for (size_t node = ranges[i].first; node < ranges[i].second; ++node)
        if (counted_[problem_.first_layer][node] != 0) start[node] |= Mask{1} << i;
    std::vector<Mask> masks = start;
    for (size_t t = 0; t < count; ++t) {
      CheckStop(problem_.stop);
      masks = Step(t, masks);
    }
    Mask returning = 0;
    for (size_t node = 0; node < start.size(); ++node) returning |= start[node] & masks[node];
    return returning;
  }

 private:
  size_t At(size_t t) const { return (problem_.first_layer + t) % problem_.layers.size(); }
  const Layer& LayerAt(size_t t) const { return problem_.layers[At(t)]; }

  /// From layer t to the next.
  std::vector<Mask> Step(size_t t, const std::vector<Mask>& masks) const {
    const Layer &from = LayerAt(t), &to = LayerAt(t + 1);
    const StepRule rule = problem_.RuleFrom(At(t));
    BandOfLayer band(from, BandBetween(problem_, rule, from, to), problem_.walls);
    const BlockedEdges* blocked = problem_.blocked.empty() ? nullptr : &problem_.blocked[At(t)];
    std::vector<Mask> reached(to.size(), 0);
    for (size_t node = 0; node < to.size(); ++node) {
      if (counted_[At(t + 1)][node] == 0) continue;
      const Joints q = to.joints.At(node);
      band.VisitFrom(to.LaneOf(node), to.first[node], [&](size_t first, size_t last) {
        for (size_t k = first; k < last; ++k) {
          if ((masks[k] & ~reached[node]) == 0) continue;
          if (!std::isfinite(StepCost(rule, from.joints.At(k), q))) continue;
          if (blocked && blocked->contains({k, node})) continue;
          reached[node] |= masks[k];
        }
      });
    }
    return reached;
  }

  const LadderProblem& problem_;
  NodeMask counted_;
};

}  // namespace

std::vector<char> AreReturning(const LadderProblem& problem, const std::vector<NodeRange>& ranges,
                               const NodeMask& counted) {
  const MaskSweep sweep(problem, counted);
  std::vector<char> returning(ranges.size(), 0);
  for (size_t first = 0; first < ranges.size(); first += kBits) {
    const size_t size = std::min(kBits, ranges.size() - first);
    const Mask mask = sweep.Run(std::span(ranges).subspan(first, size));
    for (size_t i = 0; i < size; ++i) returning[first + i] = static_cast<char>((mask >> i) & 1);
  }
  return returning;
}

}  // namespace millpose
