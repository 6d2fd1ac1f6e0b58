// SPDX-License-Identifier: GPL-3.0-or-later
// The local refinement after the generations.
#pragma once

#include "planning/pose/evaluator.hpp"
#include "planning/pose/line_search.hpp"

namespace millpose {

/// One local refinement: line searches along one freedom after the other on one branch.
class Climber {
 public:
  Climber(const PoseProblem& problem, const Individual& start, double step, double tolerance,
          double end_tolerance)
      : problem_(&problem),
        step_(step),
        tolerance_(tolerance),
        end_tolerance_(end_tolerance),
        place_(start.freedoms),
        branch_(start.branch),
        value_(start.objective),
        line_(Begin()) {}

  bool done() const { return done_; }
  int branch() const { return branch_; }
  const FreedomValues& freedoms() const { return place_; }
  double value() const { return value_; }
  /// The freedoms to look at next.
  const FreedomValues& Ask();
  /// The objective there; +inf where it is not admissible.
  void Tell(double value);

 private:
  LineSearch Begin() const;

  const PoseProblem* problem_;
  double step_, tolerance_, end_tolerance_;  // shares of a freedom's range
  FreedomValues place_, asked_;
  int branch_;
  double value_;
  double round_start_ = std::numeric_limits<double>::infinity();
  size_t dimension_ = 0;
  bool inside_ = true, done_ = false;
  LineSearch line_;
};

/// Lets all climbers finish side by side, or until the evaluations are spent.
void Climb(std::vector<Climber>& climbers, Evaluator& evaluator, int max_evaluations);

/// The best of the archive, each at least a niche away from the ones before on its branch.
std::vector<Individual> Niches(const PoseProblem& problem, std::vector<Individual> archive, size_t count);

}  // namespace millpose
