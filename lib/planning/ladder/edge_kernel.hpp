// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "base/lanes.hpp"
#include "machine/robot/arm.hpp"

namespace millpose {

/// What a step between neighbouring points may be and costs.
struct StepRule {
  Joints max_step = Joints::Zero();  ///< rad, hard, per joint
  double motion_weight = 0;          ///< objective units per rad²
  bool modulo_revolutions = true;    ///< joints go the short way round; else angles are taken as they stand
};

/// Nodes that are looked at together at the least, and blocks of these that are passed over together.
inline constexpr size_t kBlock = kLanes, kGroup = 8 * kBlock;

/// Joint angles of many nodes as structure of arrays. `Finish` pads to full blocks, so that kernels may read
/// beyond the end, and bounds each block and each group of blocks: the angles of the node in its middle and
/// how far the others lie from them, the short way round.
struct JointRows {
  std::array<std::vector<double>, 6> q;
  struct Bound {
    std::array<double, 6> middle, radius;
    bool same_turn = true;  ///< the others lie that near as they stand
  };
  std::vector<Bound> blocks, groups;
  size_t size = 0;

  void Add(const Joints& joints);
  void Finish();
  Joints At(size_t node) const;
};

/// `angle` less full revolutions, in [−π, π].
double WrapToPi(double angle);

/// Cost of the motion from `from` to `to`; +inf where a joint steps too far.
double StepCost(const StepRule& rule, const Joints& from, const Joints& to);

/// Costs of the ways to the nodes of a layer, padded like JointRows, and the least of each block and group.
struct CostRow {
  CostRow() = default;
  explicit CostRow(std::span<const double> of_nodes) { Set(of_nodes); }
  void Set(std::span<const double> of_nodes);
  size_t size() const { return count; }

  size_t count = 0;
  std::vector<double> costs, block_least, group_least;
};

/// The predecessor of least cost for one node.
struct BestPredecessor {
  double cost = std::numeric_limits<double>::infinity();
  size_t node = 0;
};

/// Looks at predecessors first..last−1 with costs `row` for a node at `to`; keeps the first of equals, and
/// what `best` holds unless a predecessor is cheaper. `at_most`: the best is known to cost no more than that.
/// Whole blocks and groups that lie too far away or cost too much are passed over. Sums are in one order, so
/// that the result does not depend on the instruction set, nor on what was passed over.
void RelaxFrom(const StepRule& rule, const JointRows& nodes, const CostRow& row, size_t first, size_t last,
               const Joints& to, double at_most, BestPredecessor& best);

}  // namespace millpose
