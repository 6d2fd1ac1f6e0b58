// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/ladder/mask_kernel.hpp"

#include "tests/planning/pass/random_layers.hpp"

namespace millpose {
namespace {

/// Nodes whose neighbours lie near one another, as those of a layer do; some have turned once more.
JointRows Rows(RandomStream& stream, int count) {
  JointRows rows;
  for (int k = 0; k < count; ++k) {
    Joints q;
    for (int j = 0; j < 6; ++j) q[j] = 0.02 * k + 0.1 * stream.Normal() + (stream.Below(9) ? 0.0 : 2 * kPi);
    rows.Add(q);
  }
  rows.Finish();
  return rows;
}

TEST(ReachBlock, AddsTheMasksOfAllWithinAStep) {
  int reached = 0, apart = 0;
  for (int trial = 0; trial < 200; ++trial) {
    RandomStream stream(81, static_cast<uint64_t>(trial));
    const JointRows from = Rows(stream, 70), to = Rows(stream, 60);
    // Where nearly all are reached from the same sets, most blocks add nothing.
    const Mask common = trial % 3 == 0 ? 0 : Mask{stream.Below(1 << 20) + 1u};
    std::vector<Mask> masks(from.size, 0);
    for (Mask& mask : masks) {
      if (stream.Below(4) != 0) mask = common;
      if (stream.Below(6) == 0) mask |= Mask{1} << stream.Below(64);
    }
    StepRule rule = Rule(trial % 4 == 0 ? 150 : 25);
    rule.modulo_revolutions = trial % 2 == 0;
    const MaskRow row(masks);
    for (size_t begin = 0; begin < to.size; begin += kBlock) {
      MaskTargets targets;
      targets.nodes = &to;
      targets.begin = begin;
      std::array<Mask, kBlock> expected{};
      for (size_t l = 0; l < kBlock && begin + l < to.size; ++l) {
        targets.first[l] = static_cast<size_t>(stream.Below(40));
        targets.last[l] = targets.first[l] + static_cast<size_t>(stream.Below(31));
        expected[l] = targets.reached[l] = stream.Below(5) == 0 ? Mask{2} : 0;
        for (size_t k = targets.first[l]; k < targets.last[l]; ++k)
          if (std::isfinite(StepCost(rule, from.At(k), to.At(begin + l)))) expected[l] |= masks[k];
        reached += expected[l] != 0;
        apart += expected[l] != common && expected[l] != 0;
      }
      ReachBlock(rule, from, row, targets);
      ASSERT_EQ(targets.reached, expected) << trial << ' ' << begin;
    }
  }
  EXPECT_GT(reached, 2000);
  EXPECT_GT(apart, 500);
}

}  // namespace
}  // namespace millpose
