// SPDX-License-Identifier: GPL-3.0-or-later
// A cell as ROS describes robots (docs/ros.md): http://wiki.ros.org/urdf/XML and .../srdf.
#pragma once

#include <map>
#include <string>

#include "report/ros/ros_names.hpp"

namespace millpose {

/// The cell as a URDF, metres and radians, and the meshes that it names, by their names in its folder.
struct CellUrdf {
  std::string text;
  std::map<std::string, std::string> meshes;  ///< binary STL, metres
};

/// The tree: world, what external axes carry, base_link, link_1 … link_6, tool0 (F), tool_tip (T); every body
/// is a link of its own, fixed to what it hangs on, with the shapes that the cell's world checks (a frustum
/// as the polyhedron around it). Joint angles, signs, zeros and limits are the arm's own. `meshes`: what
/// stands before the names of meshes. Precondition: the cell's external axes stand at 0, and it has no
/// deviations.
CellUrdf MakeCellUrdf(const Cell& cell, const RosNames& names, const std::string& meshes);

/// Groups manipulator (base_link to tool_tip), external_axes and both, the home pose, and every pair of links
/// that no check of the cell looks at (NeverChecked).
std::string CellSrdf(const Cell& cell, const RosNames& names);

}  // namespace millpose
