// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "path/edge_kernel.hpp"
#include "pose/search.hpp"

namespace millpose {

/// The admissible candidates of one milling point: branch by branch, in ascending order of the first freedom.
struct Layer {
  JointRows joints;
  std::vector<double> objective;  ///< +inf for a node that was pruned
  std::vector<FreedomValues> freedoms;
  std::vector<double> first;  ///< the first freedom again, for the band
  std::vector<size_t> base;   ///< equal for nodes that differ by full revolutions only; these are neighbours
  std::vector<bool> genetic;  ///< the genetic algorithm's answer
  std::array<size_t, 9> branch_begin{};  ///< nodes of branch b: branch_begin[b] .. branch_begin[b+1]−1
  Eigen::Matrix3d R_WT = Eigen::Matrix3d::Identity();  ///< of the tool where all freedoms are 0

  /// Some node is not pruned.
  bool usable() const;
  size_t size() const { return joints.size; }
  int BranchOf(size_t node) const;
};

/// A candidate to become a node.
struct NodeSeed {
  FreedomValues freedoms;
  Candidate candidate;
  int branch = 0;
  bool genetic = false;
};

/// Sorts the admissible of `seeds` into a layer. `all_revolutions` makes a node of every full-revolution
/// variant within the bounds, else each stands for all of its own.
Layer MakeLayer(const PointScorer& scorer, std::vector<NodeSeed> seeds, bool all_revolutions);

/// All of a table.
std::vector<NodeSeed> SeedsOf(const CandidateTable& table);

}  // namespace millpose
