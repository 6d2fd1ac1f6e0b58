// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/layer_steps.hpp"

#include <bit>

#include "machine/motion/line.hpp"
#include "planning/ladder/block_kernel.hpp"

namespace millpose {
namespace {

/// So many nodes of a block or fewer are looked at one by one.
constexpr int kFew = 2;

}  // namespace

double BandBetween(const LadderProblem& problem, const StepRule& rule, const Layer& from, const Layer& to) {
  return problem.banded ? BandWidth(rule, AngleBetween(from.R_WT, to.R_WT))
                        : std::numeric_limits<double>::infinity();
}

LayerSteps::LayerSteps(const Layer& source, const Layer& target, const Law& law)
    : source_(source), target_(target), law_(law), band_(source, law.band, law.walls) {}

void LayerSteps::Relax(const CostRow& row, const std::vector<char>& wanted,
                       std::vector<BestPredecessor>& best) {
  const int lanes = static_cast<int>(target_.lane_begin.size()) - 1;
  for (int lane = 0; lane < lanes; ++lane) {
    const size_t first = target_.lane_begin[lane], last = target_.lane_begin[lane + 1];
    for (size_t begin = first / kBlock * kBlock; begin < last; begin += kBlock) {
      unsigned nodes = 0;
      for (size_t node = std::max(begin, first); node < std::min(begin + kBlock, last); ++node)
        if (wanted[node] != 0) nodes |= 1u << (node - begin);
      if (std::popcount(nodes) > kFew) {
        RelaxBlockOf(row, lane, begin, nodes, best);
        continue;
      }
      for (; nodes != 0; nodes &= nodes - 1) {
        const size_t node = begin + static_cast<size_t>(std::countr_zero(nodes));
        RelaxOne(row, lane, node, best[node]);
      }
    }
  }
}

void LayerSteps::RelaxBlockOf(const CostRow& row, int lane, size_t begin, unsigned nodes,
                              std::vector<BestPredecessor>& best) {
  TargetBlock targets;
  targets.nodes = &target_.joints;
  targets.begin = begin;
  targets.wanted = nodes;
  std::array<std::array<size_t, kBlock>, 3> first{}, last{};  // of each part of the band
  std::array<bool, 3> some{};
  for (size_t l = 0; l < kBlock; ++l) {
    if ((nodes >> l & 1u) == 0) continue;
    targets.best[l] = {best[begin + l].cost, kNoNode};
    const std::array<NodeRange, 3> ranges = band_.RangesFrom(lane, target_.first[begin + l]);
    for (size_t part = 0; part < 3; ++part) {
      std::tie(first[part][l], last[part][l]) = ranges[part];
      some[part] = some[part] || first[part][l] < last[part][l];
    }
  }
  for (size_t part = 0; part < 3; ++part) {
    if (!some[part]) continue;
    targets.first = first[part], targets.last = last[part];
    RelaxBlock(law_.rule, source_.joints, row, guess_, targets);
  }
  for (size_t l = 0; l < kBlock; ++l) {
    if ((nodes >> l & 1u) == 0) continue;
    BestPredecessor& by = best[begin + l];
    const double below = by.cost;
    by = targets.best[l];
    Found(row, lane, begin + l, below, by);
  }
}

void LayerSteps::RelaxOne(const CostRow& row, int lane, size_t node, BestPredecessor& by) {
  const double below = by.cost;
  by.node = kNoNode;
  const Joints q = target_.joints.At(node);
  band_.VisitFrom(lane, target_.first[node], [&](size_t first, size_t last) {
    double at_most = by.cost;
    // That of the node before and the one after it.
    for (size_t k = guess_; k < guess_ + 2; ++k) {
      if (k < first || k >= last) continue;
      at_most = std::min(at_most, row.costs[k] + StepCost(law_.rule, source_.joints.At(k), q));
    }
    RelaxFrom(law_.rule, source_.joints, row, first, last, q, at_most, by);
  });
  Found(row, lane, node, below, by);
}

/// What was found for a node may be barred, or be nothing.
void LayerSteps::Found(const CostRow& row, int lane, size_t node, double below, BestPredecessor& by) {
  if (by.node != kNoNode) {
    guess_ = by.node;
    if (law_.blocked && law_.blocked->contains({by.node, node})) {
      by = {below, kNoNode};
      RelaxUnbarred(row, lane, node, by);
    }
  }
  if (by.node == kNoNode) by = {};
}

/// Rare: the best is barred, so look again, one by one.
void LayerSteps::RelaxUnbarred(const CostRow& row, int lane, size_t node, BestPredecessor& by) {
  const Joints q = target_.joints.At(node);
  band_.VisitFrom(lane, target_.first[node], [&](size_t first, size_t last) {
    for (size_t k = first; k < last; ++k) {
      const double cost = row.costs[k] + StepCost(law_.rule, source_.joints.At(k), q);
      if (cost < by.cost && !law_.blocked->contains({k, node})) by = {cost, k};
    }
  });
}

}  // namespace millpose
