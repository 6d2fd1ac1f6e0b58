// SPDX-License-Identifier: GPL-3.0-or-later
// One rotation for each point of a sampled pass on one branch, for `place`.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <optional>

#include "machine/robot/arm.hpp"
#include "planning/ladder/scored_point.hpp"
#include "planning/pose/candidate_table.hpp"

namespace millpose {

/// The points of a pass, all on one branch.
struct BranchScore {
  std::vector<ScoredPoint> points;
  size_t free = 0;   ///< how many
  double worst = 0;  ///< objective of these
};

/// More free points first, then the less bad worst one.
bool IsBetter(const BranchScore& a, const BranchScore& b);

/// Of every branch what no way along it beats: each point by itself, interference left aside.
std::array<BranchScore, 8> PromisesOf(const std::vector<CandidateTable>& tables);

/// A pass on one branch: of each point one rotation, not far from those of its neighbours, the worst point
/// first, then the sum.
class BranchLadder {
 public:
  /// `tables`: one of each point, of the same settings; they outlive it.
  BranchLadder(const AdmissibleBounds& bounds, const std::vector<CandidateTable>& tables, size_t branch);

  /// Interference left aside.
  BranchScore Bound() const { return Result(Choose()); }

  /// What is asked of candidates: whether the arm may stand so, and whether it can leave a pass there, which
  /// costs far more.
  struct Looks {
    std::function<bool(size_t point, const Joints& q, const FreedomValues& freedoms)> stands;
    std::function<bool(size_t point, const Joints& q)> leaves;
  };
  /// Looked at for interference; something no better than `best` where it cannot be better.
  BranchScore Score(const Looks& look, const std::optional<BranchScore>& best);

 private:
  static constexpr size_t kNoSetting = std::numeric_limits<size_t>::max();
  struct Node {
    double objective = std::numeric_limits<double>::infinity();
    size_t entry = 0;
    bool stands = false, leaves = false;  ///< free of interference, as looked at
  };
  struct Layer {
    std::vector<Node> nodes;
    bool blocked = false;  ///< some node interferes
  };
  /// What is chosen of a layer. A pass that no way leads along is broken: there the tool is lifted.
  struct Choice {
    size_t setting = kNoSetting;
    bool after_break = false;
  };

  struct Cost;

  template <class Look>
  bool AllAre(bool Node::*what, const std::vector<Choice>& chosen, const Look& look);
  std::vector<Choice> Choose() const;
  static std::vector<size_t> CheapestNear(const std::vector<Cost>& costs);
  size_t BestBefore(const std::vector<Cost>& costs, size_t near, size_t t, size_t u, size_t to) const;
  bool Leads(size_t t, size_t from, size_t u, size_t to) const;
  BranchScore Result(const std::vector<Choice>& chosen) const;

  std::vector<int> stopped_;  ///< joints that cannot go round, and turn far enough to be stopped by a limit
  const std::vector<CandidateTable>* tables_;
  std::vector<Layer> layers_;
};

}  // namespace millpose
