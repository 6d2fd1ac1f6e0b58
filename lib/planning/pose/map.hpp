// SPDX-License-Identifier: GPL-3.0-or-later
// An index over a plane of the cell (Chen 2021 fig. 3 shows the dexterity so).
#pragma once

#include <string>
#include <vector>

#include "machine/stiffness/series.hpp"

namespace millpose {

/// A grid of tip positions origin + i·u + j·v in B, the tool's direction, and what is drawn there.
struct MapRequest {
  Arm arm;
  Joints lower, upper;  ///< limits that count, rad
  Pose X_FT = Pose::Identity();
  bool at_flange =
      false;  ///< compliance at the flange's origin, to reproduce the paper; dexterity is at the tip
  double characteristic_length = 1000;     ///< mm, for dexterity
  std::vector<SeriesCompliance> elements;  ///< beside the joints
  Eigen::Vector3d origin, u, v;            ///< mm
  int u_count = 0, v_count = 0;
  Eigen::Vector3d tool_axis, normal;  ///< unit, in B; T's z, and the milling plane's normal
  std::string index = "dexterity";    ///< one of MapIndices()
  double rotation_step = 0.1;         ///< grid of rotations about the tool axis, rad
};

/// Name and unit of what can be drawn: the indices of docs/stiffness.md and the objectives (with the
/// parameters that they have by default) that do not depend on the feed.
struct MapIndex {
  std::string name, unit;
};
const std::vector<MapIndex>& MapIndices();

/// The best pose of a grid point within the limits: greatest dexterity or μ, least of any other index.
struct MapPoint {
  Eigen::Vector3d point;  ///< in B, mm
  bool reached = false;   ///< some pose is within the limits and regular
  double value = 0;
  double rotation = 0;  ///< about the tool axis, from BasisOfPlane(tool_axis).first, rad
  int branch = 0;
  Joints q = Joints::Zero();
};

/// Row by row: index j·u_count + i.
std::vector<MapPoint> DrawMap(const MapRequest& request);

/// The same as CSV (points that are not reached have empty cells) and as legacy VTK structured points data
/// (NaN is not written: the field `reached` tells).
std::string MapToCsv(const MapRequest& request, const std::vector<MapPoint>& points);
std::string MapToVtk(const MapRequest& request, const std::vector<MapPoint>& points);

}  // namespace millpose
