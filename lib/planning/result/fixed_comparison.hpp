// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "planning/result/gear_course.hpp"

namespace millpose {

/// A figure over all compared points.
struct OverPoints {
  double worst = 0, median = 0, sum = 0;
};

/// The compared points in the poses of the plan or of a choice.
struct ComparedFigures {
  size_t points = 0;     ///< 0: there is no such choice
  OverPoints objective;  ///< in its unit
  OverPoints normal;     ///< |nᵀcF|, mm; 0 without force
  OverPoints length;     ///< |cF|, mm
};

/// A rotation of the whole job or one of each pass.
struct FixedChoice {
  ComparedFigures figures;
  std::vector<double> rotations;  ///< rad: one, or of each compared pass
  GearTally gears;                ///< where joints turn back with it, entered as the plan is

  bool Exists() const { return figures.points > 0; }
};

/// A plan beside the best single rotation of the job and the best of each pass. One counts only where it
/// serves every planned point of a pass on one branch, within the same limits, joint steps and clearances, on
/// the motions between points too; ways between passes are not planned for it. Compared are the planned cut
/// points, where forces are known those that are not in air.
struct FixedComparison {
  ComparedFigures plan;
  GearTally plan_gears;
  FixedChoice job, passes;  ///< best by the criterion that was planned for
  /// Least sum among those whose worst value is within kNearBest of the least worst.
  FixedChoice job_by_sum, passes_by_sum;
  /// Best in |cF| by the same criterion, whatever was planned for; none where forces are not known.
  FixedChoice job_by_length, passes_by_length;
  std::string job_in_the_way, passes_in_the_way;  ///< one sentence each, where there is none
};

inline constexpr double kNearBest = 0.05;  ///< share

}  // namespace millpose
