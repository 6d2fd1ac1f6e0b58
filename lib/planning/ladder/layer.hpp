// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "planning/ladder/edge_kernel.hpp"
#include "planning/pose/search.hpp"

namespace millpose {

/// The admissible candidates of one milling point, lane by lane, in ascending order of the first freedom.
/// What a ladder search joins keeps its lane: the branch and, where freedoms lean the tool, the course of the
/// lean along the pass (lean_courses.hpp).
struct Layer {
  JointRows joints;
  std::vector<double> objective;        ///< +inf for a node that was pruned
  std::vector<FreedomValues> freedoms;  ///< empty where the first is the only one: FreedomsOf
  std::vector<double> first;            ///< the first freedom again, for the band
  std::vector<size_t> base;   ///< equal for nodes that differ by full revolutions only; these are neighbours
  std::vector<bool> genetic;  ///< the genetic algorithm's answer
  /// Nodes of lane l: lane_begin[l] .. lane_begin[l+1]−1; lane 8·course + branch.
  std::vector<size_t> lane_begin = std::vector<size_t>(9, 0);
  Eigen::Matrix3d R_WT = Eigen::Matrix3d::Identity();  ///< of the tool where all freedoms are 0

  /// Some node is not pruned.
  bool usable() const;
  size_t size() const { return joints.size; }
  int LaneOf(size_t node) const;
  int BranchOf(size_t node) const { return LaneOf(node) % 8; }
};

/// A candidate to become a node.
struct NodeSeed {
  FreedomValues freedoms;
  Candidate candidate;
  int branch = 0;
  bool genetic = false;
  int course = 0;

  int lane() const { return 8 * course + branch; }
};

/// Sorts the admissible of `seeds` into a layer. `all_revolutions` makes a node of every full-revolution
/// variant within the bounds, else each stands for all of its own.
Layer MakeLayer(const PointScorer& scorer, std::vector<NodeSeed> seeds, bool all_revolutions,
                int courses = 1);

/// All of a table.
std::vector<NodeSeed> SeedsOf(const CandidateTable& table);
/// Of a table those whose further freedoms stand as one of `leans` says (setting % CandidateTable::stride()):
/// the k-th is course k.
std::vector<NodeSeed> SeedsOf(const CandidateTable& table, std::span<const size_t> leans);

}  // namespace millpose
