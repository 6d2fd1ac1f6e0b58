// SPDX-License-Identifier: GPL-3.0-or-later
// What the genetic algorithm and its local refinement share: the individual, and the counted look at
// candidates.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "planning/pose/search.hpp"

namespace millpose {

/// The genome is the freedoms and the arm branch (shoulder and elbow). Of the two wrist flips it stands for
/// the one that is admissible, or nearer to it, and of two admissible ones for the better.
struct Individual {
  FreedomValues freedoms;
  int arm_branch = 0;
  int branch = 0;
  Infeasibility obstacle = Infeasibility::kUnreachable;
  double objective = std::numeric_limits<double>::infinity();  ///< +inf unless admissible
  double shortfall = std::numeric_limits<double>::infinity();
};

/// Admissible before not admissible; then by objective, or by how little is missing.
bool Fitter(const Individual& a, const Individual& b);

/// What is looked at: `freedoms` on one arm branch. Fills in blocks and counts one evaluation for each.
class Evaluator {
 public:
  Evaluator(const PointScorer& scorer, PointOptimum& best)
      : scorer_(scorer),
        dimensions_(scorer.problem().freedoms.size()),
        best_(best),
        lanes_(kLanes * dimensions_) {}

  int evaluations() const { return best_.evaluations; }
  /// Evaluations made elsewhere.
  void Count(int evaluations) { best_.evaluations += evaluations; }

  /// Calls `take(k, block, lane)` for each of `count` requests; `freedoms(k)` and `arm_branch(k)` say what is
  /// asked.
  template <typename Freedoms, typename ArmBranch, typename Take>
  void Run(size_t count, const Freedoms& freedoms, const ArmBranch& arm_branch, const Take& take) {
    for (size_t first = 0; first < count; first += kLanes) {
      const size_t used = std::min<size_t>(kLanes, count - first);
      unsigned arms = 0;
      for (size_t l = 0; l < kLanes; ++l) {
        const size_t k = first + std::min(l, used - 1);
        const FreedomValues& values = freedoms(k);
        std::copy(values.begin(), values.end(), lanes_.begin() + l * dimensions_);
        arms |= 1u << arm_branch(k);
      }
      scorer_.ScoreBlock(lanes_, arms, block_);
      best_.evaluations += static_cast<int>(used);
      for (size_t l = 0; l < used; ++l) {
        const int arm = arm_branch(first + l);
        for (const int branch : {arm, arm + 4}) Consider(branch, static_cast<int>(l), freedoms(first + l));
        take(first + l, block_, static_cast<int>(l));
      }
    }
  }

 private:
  void Consider(int branch, int lane, const FreedomValues& freedoms);

  const PointScorer& scorer_;
  size_t dimensions_;
  PointOptimum& best_;
  std::vector<double> lanes_;
  ScoredBlock block_;
};

/// Brings a periodic freedom back into its range and stops the others at theirs.
double Confine(const Freedom& freedom, double value);

/// b − a, the short way round where the freedom is periodic.
double Difference(const Freedom& freedom, double a, double b);

}  // namespace millpose
