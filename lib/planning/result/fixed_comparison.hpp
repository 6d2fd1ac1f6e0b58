// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace millpose {

/// Figures of one point in one pose.
struct PointFigures {
  double objective = 0;
  double normal = 0;  ///< |nᵀcF|, mm; 0 without force
  double length = 0;  ///< |cF|, mm
};

/// A plan beside the best single rotation of the job and the best of each pass. One counts only where it
/// serves every planned point of a pass on one branch, within the same limits, joint steps and clearances, on
/// the motions between points too; ways between passes are not planned for it. Compared are the planned cut
/// points, where forces are known those that are not in air.
struct FixedComparison {
  std::vector<PointFigures> plan;
  std::vector<PointFigures> job;                  ///< empty when no rotation serves all
  double rotation = 0;                            ///< of `job`, rad
  std::vector<PointFigures> passes;               ///< empty when one pass has none
  std::string job_in_the_way, passes_in_the_way;  ///< one sentence each, where there is none
};

}  // namespace millpose
