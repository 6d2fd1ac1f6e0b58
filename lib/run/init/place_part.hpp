// SPDX-License-Identifier: GPL-3.0-or-later
// Where a part could stand before an arm, and how well the arm gets at it there.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "job/inputs.hpp"
#include "job/workpiece.hpp"
#include "run/init/facing_groups.hpp"

namespace millpose {

/// One place of a part in W.
struct Placement {
  Pose X_WP = Pose::Identity();
  bool upright = false;  ///< what is milled stands like a wall before the arm; else it lies like a table
};

/// Places that are worth trying, the likelier first: the group's seed at usual distances and heights before
/// the arm as it stands at home. Numbers are round (0.1 mm, 0.001°), so that a file can hold them.
std::vector<Placement> LikelyPlacements(const FacingGroup& group, const ImportReport& part, const Cell& cell,
                                        const Joints& home);

/// In-plane directions of a group: `along` the longer side of its bounds. Both unit, across its direction.
struct GroupSides {
  Eigen::Vector3d along, across;
  double length = 0, width = 0;  ///< mm
};
GroupSides SidesOf(const FacingGroup& group);

/// Of the placements those at which some pose within the job's limits, clear of the whole cell, mills each of
/// a few points of the tool path (in P), the ones with most room to turn the tool first. Throws Interrupted.
std::vector<Placement> ReachedPlacements(const JobInputs& inputs, const Mesh& mesh, const Toolpath& toolpath,
                                         const std::vector<Placement>& placements, size_t most,
                                         const std::stop_token& stop);

}  // namespace millpose
