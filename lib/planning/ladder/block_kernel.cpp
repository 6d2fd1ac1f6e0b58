// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/block_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "planning/ladder/block_pair.hpp"

namespace millpose {
namespace {

static_assert(kBlock == 8);

constexpr double kLess = 1 - 1e-12;  // rounding of a lower bound

/// The targets as lanes, and what was found for them.
struct Found {
  Lanes t[6], first, last, cost, node;
};

/// Looks at the eight predecessors from `block` on for all targets; `way` gives the signed step of joint i.
/// Of equals the first is kept: those before what was looked at come last to first.
template <bool kBefore, typename Way>
[[gnu::always_inline]] inline void LookAt(InstructionSet set, const StepRule& rule, const JointRows& nodes,
                                          const double* row, size_t block, const Way& way, Found& found) {
  const double *q0 = &nodes.q[0][block], *q1 = &nodes.q[1][block], *q2 = &nodes.q[2][block],
               *q3 = &nodes.q[3][block], *q4 = &nodes.q[4][block], *q5 = &nodes.q[5][block];
  const double* costs = row + block;
  const double m0 = rule.max_step[0], m1 = rule.max_step[1], m2 = rule.max_step[2];
  const double m3 = rule.max_step[3], m4 = rule.max_step[4], m5 = rule.max_step[5];
  const double weight = rule.motion_weight, begin = static_cast<double>(block);
  ForEachLane(set, [&] [[gnu::always_inline]] (int l) {
    const double t0 = found.t[0].v[l], t1 = found.t[1].v[l], t2 = found.t[2].v[l];
    const double t3 = found.t[3].v[l], t4 = found.t[4].v[l], t5 = found.t[5].v[l];
    const double first = found.first.v[l], last = found.last.v[l];
    double best = found.cost.v[l], node = found.node.v[l];
    const auto take = [&] [[gnu::always_inline]] (int n) {
      const int k = kBefore ? static_cast<int>(kBlock) - 1 - n : n;
      const double d0 = way(0, t0 - q0[k]), d1 = way(1, t1 - q1[k]), d2 = way(2, t2 - q2[k]);
      const double d3 = way(3, t3 - q3[k]), d4 = way(4, t4 - q4[k]), d5 = way(5, t5 - q5[k]);
      const double sum = ((((d0 * d0 + d1 * d1) + d2 * d2) + d3 * d3) + d4 * d4) + d5 * d5;
      const double at = begin + k;
      const bool within = (std::fabs(d0) <= m0) & (std::fabs(d1) <= m1) & (std::fabs(d2) <= m2) &
                          (std::fabs(d3) <= m3) & (std::fabs(d4) <= m4) & (std::fabs(d5) <= m5) &
                          (at >= first) & (at < last);
      const double cost = costs[k] + weight * sum;
      const bool better = within & (kBefore ? cost <= best : cost < best);
      best = better ? cost : best;
      node = better ? at : node;
    };
    take(0), take(1), take(2), take(3), take(4), take(5), take(6), take(7);  // a loop would not vectorise
    found.cost.v[l] = best;
    found.node.v[l] = node;
  });
}

class BlockRelaxer {
 public:
  BlockRelaxer(const StepRule& rule, const JointRows& from, const CostRow& row, TargetBlock& targets)
      : rule_(rule),
        from_(from),
        row_(row),
        targets_(targets),
        bound_(targets.nodes->blocks[targets.begin / kBlock]) {
    for (size_t l = 0; l < kBlock; ++l) {
      found_.cost.v[l] = kInfinity;
      found_.first.v[l] = found_.last.v[l] = found_.node.v[l] = 0;
      if (!Wanted(l) || targets.first[l] >= targets.last[l]) continue;
      found_.first.v[l] = static_cast<double>(targets.first[l]);
      found_.last.v[l] = static_cast<double>(targets.last[l]);
      first_ = std::min(first_, targets.first[l]);
      last_ = std::max(last_, targets.last[l]);
    }
  }

  void Run(size_t guess) {
    if (first_ >= last_) return;
    guess = std::clamp(guess, first_, last_ - 1) / kBlock * kBlock;
    Bound();
    Try<false>(guess);
    Before(guess);
    for (size_t block = guess + kBlock; block < last_;) {
      const size_t group = block / kGroup * kGroup;
      if (PassedOver(row_.group_least[group / kGroup], from_.groups[group / kGroup])) {
        block = group + kGroup;
        continue;
      }
      for (const size_t end = std::min(group + kGroup, last_); block < end; block += kBlock)
        Try<false>(block);
    }
    if (!loaded_) return;
    for (size_t l = 0; l < kBlock; ++l)
      if (Wanted(l) && found_.cost.v[l] < targets_.best[l].cost)
        targets_.best[l] = {found_.cost.v[l], static_cast<size_t>(found_.node.v[l])};
  }

 private:
  bool Wanted(size_t lane) const { return (targets_.wanted >> lane & 1u) != 0; }

  /// The blocks below `end`, the last first.
  void Before(size_t end) {
    const size_t begin = first_ / kBlock * kBlock;
    while (end > begin) {
      const size_t group = (end - kBlock) / kGroup * kGroup, first = std::max(group, begin);
      if (!PassedOver(row_.group_least[group / kGroup], from_.groups[group / kGroup]))
        for (size_t block = end; block > first; block -= kBlock) Try<true>(block - kBlock);
      end = first;
    }
  }

  template <bool kBefore>
  void Try(size_t block) {
    if (!PassedOver(row_.block_least[block / kBlock], from_.blocks[block / kBlock])) Look<kBefore>(block);
  }

  /// The most that a wanted node is known to cost.
  void Bound() {
    at_most_ = 0;
    for (size_t l = 0; l < kBlock; ++l)
      if (found_.last.v[l] > 0)
        at_most_ = std::max(at_most_, std::min(found_.cost.v[l], targets_.best[l].cost));
  }

  /// No predecessor of a block or group is better for any target: it costs too much, or lies too far away.
  bool PassedOver(double least, const JointRows::Bound& bound) const {
    if (least > at_most_) return true;
    double square = 0;
    if (!block_pair::MayReach(rule_, bound, bound_, square)) return true;
    return least + kLess * rule_.motion_weight * square > at_most_;
  }

  /// The angles of the targets: only where something is looked at, which beside an earlier part of a band is
  /// rare.
  void Load() {
    for (int i = 0; i < 6; ++i) block_pair::Load(targets_.nodes->q[i], targets_.begin, found_.t[i]);
    loaded_ = true;
  }

  template <bool kBefore>
  void Look(size_t block) {
    if (!loaded_) Load();
    block_pair::ByTheShortWay(block_pair::ShiftsBetween(rule_, from_.blocks[block / kBlock], bound_),
                              [&] [[gnu::always_inline]] (const auto& way) {
                                LookAt<kBefore>(block_pair::Widest(), rule_, from_, row_.costs.data(), block,
                                                way, found_);
                              });
    Bound();
  }

  const StepRule& rule_;
  const JointRows& from_;
  const CostRow& row_;
  TargetBlock& targets_;
  const JointRows::Bound& bound_;
  size_t first_ = std::numeric_limits<size_t>::max(), last_ = 0;
  Found found_;
  double at_most_ = kInfinity;
  bool loaded_ = false;
};

}  // namespace

void RelaxBlock(const StepRule& rule, const JointRows& from, const CostRow& row, size_t guess,
                TargetBlock& targets) {
  BlockRelaxer(rule, from, row, targets).Run(guess);
}

}  // namespace millpose
