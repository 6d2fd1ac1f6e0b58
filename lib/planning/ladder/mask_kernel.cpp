// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/mask_kernel.hpp"

#include <algorithm>
#include <cstring>

#include "planning/ladder/block_pair.hpp"

namespace millpose {
namespace {

struct alignas(64) MaskLanes {
  Mask v[kLanes];
};

/// The targets as lanes, and from where they are reached.
struct Reached {
  Lanes t[6], first, last;
  MaskLanes masks;
};

/// Looks at the eight predecessors from `block` on for all targets, or at one.
template <bool kAll, typename Way>
[[gnu::always_inline]] inline void LookAt(InstructionSet set, const StepRule& rule, const JointRows& nodes,
                                          const Mask* masks, size_t block, const Way& way, Reached& reached) {
  const double *q0 = &nodes.q[0][block], *q1 = &nodes.q[1][block], *q2 = &nodes.q[2][block],
               *q3 = &nodes.q[3][block], *q4 = &nodes.q[4][block], *q5 = &nodes.q[5][block];
  const Mask* of = masks + block;
  const double m0 = rule.max_step[0], m1 = rule.max_step[1], m2 = rule.max_step[2];
  const double m3 = rule.max_step[3], m4 = rule.max_step[4], m5 = rule.max_step[5];
  const double begin = static_cast<double>(block);
  ForEachLane(set, [&] [[gnu::always_inline]] (int l) {
    const double t0 = reached.t[0].v[l], t1 = reached.t[1].v[l], t2 = reached.t[2].v[l];
    const double t3 = reached.t[3].v[l], t4 = reached.t[4].v[l], t5 = reached.t[5].v[l];
    const double first = reached.first.v[l], last = reached.last.v[l];
    Mask mask = reached.masks.v[l];
    const auto take = [&] [[gnu::always_inline]] (int k) {
      const double at = begin + k;
      const double d0 = way(0, t0 - q0[k]), d1 = way(1, t1 - q1[k]), d2 = way(2, t2 - q2[k]);
      const double d3 = way(3, t3 - q3[k]), d4 = way(4, t4 - q4[k]), d5 = way(5, t5 - q5[k]);
      const bool within = (std::fabs(d0) <= m0) & (std::fabs(d1) <= m1) & (std::fabs(d2) <= m2) &
                          (std::fabs(d3) <= m3) & (std::fabs(d4) <= m4) & (std::fabs(d5) <= m5) &
                          (at >= first) & (at < last);
      mask |= within ? of[k] : Mask{0};
    };
    take(0);
    if constexpr (kAll)
      take(1), take(2), take(3), take(4), take(5), take(6), take(7);  // a loop would not vectorise
    reached.masks.v[l] = mask;
  });
}

class BlockReacher {
 public:
  BlockReacher(const StepRule& rule, const JointRows& from, const MaskRow& row, MaskTargets& targets)
      : rule_(rule),
        from_(from),
        row_(row),
        targets_(targets),
        bound_(targets.nodes->blocks[targets.begin / kBlock]) {
    for (size_t l = 0; l < kBlock; ++l) {
      reached_.masks.v[l] = targets.reached[l];
      reached_.first.v[l] = static_cast<double>(targets.first[l]);
      reached_.last.v[l] = static_cast<double>(targets.last[l]);
      if (targets.first[l] >= targets.last[l]) continue;
      first_ = std::min(first_, targets.first[l]);
      last_ = std::max(last_, targets.last[l]);
    }
  }

  void Run() {
    if (first_ >= last_) return;
    for (int i = 0; i < 6; ++i) block_pair::Load(targets_.nodes->q[i], targets_.begin, reached_.t[i]);
    Known();
    // From the middle outward: what lies nearest is most likely to be within a step, and often is from where
    // all are reached.
    Look<false>((first_ + last_) / 2);
    const size_t middle = (first_ + last_) / 2 / kBlock * kBlock;
    for (size_t block = middle; block < last_; block += kBlock) Try(block);
    for (size_t block = middle; block > first_ / kBlock * kBlock; block -= kBlock) Try(block - kBlock);
    std::memcpy(targets_.reached.data(), reached_.masks.v, sizeof targets_.reached);
  }

 private:
  /// From where all targets are reached that anything reaches.
  void Known() {
    all_ = ~Mask{0};
    for (size_t l = 0; l < kBlock; ++l)
      if (targets_.first[l] < targets_.last[l]) all_ &= reached_.masks.v[l];
  }

  void Try(size_t block) {
    double square = 0;
    if ((row_.of_blocks[block / kBlock] & ~all_) == 0) return;
    if (block_pair::MayReach(rule_, from_.blocks[block / kBlock], bound_, square)) Look<true>(block);
  }

  template <bool kAll>
  void Look(size_t node) {
    const JointRows::Bound& bound = from_.blocks[node / kBlock];
    block_pair::ByTheShortWay(
        block_pair::ShiftsBetween(rule_, bound, bound_), [&] [[gnu::always_inline]] (const auto& way) {
          LookAt<kAll>(block_pair::Widest(), rule_, from_, row_.masks.data(), node, way, reached_);
        });
    Known();
  }

  const StepRule& rule_;
  const JointRows& from_;
  const MaskRow& row_;
  MaskTargets& targets_;
  const JointRows::Bound& bound_;
  size_t first_ = std::numeric_limits<size_t>::max(), last_ = 0;
  Reached reached_;
  Mask all_ = 0;
};

}  // namespace

void MaskRow::Set(std::span<const Mask> of_nodes) {
  masks.assign(of_nodes.begin(), of_nodes.end());
  of_blocks.assign((masks.size() + kBlock - 1) / kBlock, 0);
  for (size_t node = 0; node < masks.size(); ++node) of_blocks[node / kBlock] |= masks[node];
  masks.resize(masks.size() + kBlock, 0);
}

bool MaskRow::Any(size_t first, size_t last) const {
  return std::any_of(masks.begin() + static_cast<std::ptrdiff_t>(first),
                     masks.begin() + static_cast<std::ptrdiff_t>(last), [](Mask mask) { return mask != 0; });
}

void ReachBlock(const StepRule& rule, const JointRows& from, const MaskRow& row, MaskTargets& targets) {
  BlockReacher(rule, from, row, targets).Run();
}

}  // namespace millpose
