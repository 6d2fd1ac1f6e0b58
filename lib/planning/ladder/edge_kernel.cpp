// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/edge_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "planning/ladder/short_way.hpp"

namespace millpose {
namespace {

using short_way::kPerTurn, short_way::kTurn, short_way::Short, short_way::Turns;

constexpr double kSlack = 1e-9;  // rad: rounding of the bounds

}  // namespace

void JointRows::Add(const Joints& joints) {
  for (int i = 0; i < 6; ++i) q[i].push_back(joints[i]);
  ++size;
}

void JointRows::Finish() {
  const auto bound = [&](size_t width) {
    std::vector<Bound> bounds((size + width - 1) / width);
    for (size_t node = 0; node < size; ++node) {
      Bound& of = bounds[node / width];
      for (int i = 0; i < 6; ++i) {
        if (node % width == 0) of.middle[i] = q[i][std::min(node + width / 2, size - 1)], of.radius[i] = 0;
        of.radius[i] = std::max(of.radius[i], std::fabs(Short(q[i][node] - of.middle[i])));
        of.same_turn = of.same_turn && std::fabs(q[i][node] - of.middle[i]) < kPi;
      }
    }
    return bounds;
  };
  for (auto& row : q) row.resize(size + kBlock, 0.0);
  blocks = bound(kBlock);
  groups = bound(kGroup);
}

void CostRow::Set(std::span<const double> of_nodes) {
  count = of_nodes.size();
  costs.assign(of_nodes.begin(), of_nodes.end());
  costs.resize(count + kBlock, kInfinity);
  const auto take_least = [](const std::vector<double>& values, size_t size, size_t width,
                             std::vector<double>& least) {
    least.assign((size + width - 1) / width, kInfinity);
    for (size_t k = 0; k < size; ++k) least[k / width] = std::min(least[k / width], values[k]);
  };
  take_least(costs, count, kBlock, block_least);
  take_least(block_least, block_least.size(), kGroup / kBlock, group_least);
}

Joints JointRows::At(size_t node) const {
  return (Joints() << q[0][node], q[1][node], q[2][node], q[3][node], q[4][node], q[5][node]).finished();
}

double WrapToPi(double angle) { return Short(angle); }

double StepCost(const StepRule& rule, const Joints& from, const Joints& to) {
  double sum = 0.0;
  for (int i = 0; i < 6; ++i) {
    const double step = Short(to[i] - from[i], rule.modulo_revolutions ? kPerTurn : 0.0);
    if (std::fabs(step) > rule.max_step[i]) return kInfinity;
    sum += step * step;
  }
  return rule.motion_weight * sum;
}

namespace {

struct Target {
  double t[6], max_step[6], shift[6];
  double weight;
};

/// Whether some node of a block or group may be within the step. `square` is the least that the joints turn
/// by, squared and summed.
bool MayReach(const JointRows::Bound& block, const Target& target, double& square) {
  constexpr std::array<int, 6> kOrder{3, 5, 4, 0, 1, 2};  // those first that turn most along a layer
  square = 0;
  for (const int i : kOrder) {
    const double apart = target.t[i] - block.middle[i];
    const double least = std::fabs(Short(apart)) - block.radius[i] - kSlack;
    if (least > target.max_step[i]) return false;
    if (least > 0) square += least * least;
  }
  return true;
}

/// Sets the turns that a block is away by; false where its nodes are not all the same turns away.
bool SetShifts(const JointRows::Bound& block, bool modulo_revolutions, Target& target) {
  bool one_shift = block.same_turn || !modulo_revolutions;
  for (int i = 0; i < 6; ++i) {
    target.shift[i] = modulo_revolutions ? Turns(target.t[i] - block.middle[i]) * kTurn : 0.0;
    one_shift = one_shift && (!modulo_revolutions || block.radius[i] + target.max_step[i] < 3.0);
  }
  return one_shift;
}

/// Costs of a block; `way` gives the signed step of joint i from angle q.
template <typename Way>
[[gnu::always_inline]] inline void CostsOfBlock(InstructionSet set, const JointRows& nodes,
                                                const double* costs, size_t block, const Target& target,
                                                const Way& way, Lanes& out) {
  const double *q0 = &nodes.q[0][block], *q1 = &nodes.q[1][block], *q2 = &nodes.q[2][block],
               *q3 = &nodes.q[3][block], *q4 = &nodes.q[4][block], *q5 = &nodes.q[5][block];
  const double weight = target.weight;
  const double m0 = target.max_step[0], m1 = target.max_step[1], m2 = target.max_step[2];
  const double m3 = target.max_step[3], m4 = target.max_step[4], m5 = target.max_step[5];
  ForEachLane(set, [&] [[gnu::always_inline]] (int l) {
    const double d0 = way(0, q0[l]), d1 = way(1, q1[l]), d2 = way(2, q2[l]);
    const double d3 = way(3, q3[l]), d4 = way(4, q4[l]), d5 = way(5, q5[l]);
    const double sum = ((((d0 * d0 + d1 * d1) + d2 * d2) + d3 * d3) + d4 * d4) + d5 * d5;
    const bool within = (std::fabs(d0) <= m0) & (std::fabs(d1) <= m1) & (std::fabs(d2) <= m2) &
                        (std::fabs(d3) <= m3) & (std::fabs(d4) <= m4) & (std::fabs(d5) <= m5);
    out.v[l] = within ? costs[l] + weight * sum : kInfinity;
  });
}

}  // namespace

void RelaxFrom(const StepRule& rule, const JointRows& nodes, const CostRow& row, size_t first, size_t last,
               const Joints& to, double at_most, BestPredecessor& best) {
  constexpr double kLess = 1 - 1e-12;  // rounding of a lower bound
  static const InstructionSet set = WidestInstructionSet();
  Target target;
  for (int i = 0; i < 6; ++i) {
    target.t[i] = to[i];
    target.max_step[i] = rule.max_step[i];
  }
  target.weight = rule.motion_weight;
  // Nothing of a block or group need be looked at: it costs too much, or lies too far away.
  const auto passed_over = [&](double least, const JointRows::Bound& bound) {
    if (least > at_most || least >= best.cost) return true;
    double square;
    if (!MayReach(bound, target, square)) return true;
    return least + kLess * rule.motion_weight * square > at_most;
  };
  const auto look = [&](size_t block) {
    Lanes out;
    // All of the block is as many turns away: that takes less arithmetic and gives the same bits.
    const auto shifted = [&] [[gnu::always_inline]] (int i, double q) {
      return (target.t[i] - q) - target.shift[i];
    };
    const auto general = [&] [[gnu::always_inline]] (int i, double q) { return Short(target.t[i] - q); };
    if (SetShifts(nodes.blocks[block / kBlock], rule.modulo_revolutions, target)) {
      CostsOfBlock(set, nodes, row.costs.data() + block, block, target, shifted, out);
    } else {
      CostsOfBlock(set, nodes, row.costs.data() + block, block, target, general, out);
    }
    const size_t begin = block < first ? first - block : 0, end = std::min(last - block, kBlock);
    for (size_t l = begin; l < end; ++l) {
      if (out.v[l] < best.cost) best = {out.v[l], block + l};
    }
  };
  const bool by_groups = last - first > kGroup;
  for (size_t group = first / kGroup * kGroup; group < last; group += kGroup) {
    if (by_groups && passed_over(row.group_least[group / kGroup], nodes.groups[group / kGroup])) continue;
    const size_t begin = std::max(group, first / kBlock * kBlock), end = std::min(last, group + kGroup);
    for (size_t block = begin; block < end; block += kBlock) {
      if (!passed_over(row.block_least[block / kBlock], nodes.blocks[block / kBlock])) look(block);
    }
  }
}

}  // namespace millpose
