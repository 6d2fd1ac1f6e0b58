// SPDX-License-Identifier: GPL-3.0-or-later
// A plan as an animated scene for those who show it: glTF 2.0, binary (docs/gltf.md).
#pragma once

#include <string>

#include "planning/result/plan_result.hpp"
#include "planning/result/timeline.hpp"
#include "report/ros/ros_names.hpp"

namespace millpose {

/// The cell with its bodies, the path on the part, a line for each piece, and one animation "run" that moves
/// the joints by `timeline`. Metres, y up, as glTF wants it: below the node that turns and scales all is W in
/// mm. Nodes have the names of the URDF (`names`). A pure function of its input. Precondition: the cell's
/// external axes stand at 0; `timeline` is not empty. Bodies keep as many triangles as in report.html.
std::string CellGltf(const Cell& cell, const RosNames& names, const PlanResult& plan,
                     const Timeline& timeline);

}  // namespace millpose
