// SPDX-License-Identifier: GPL-3.0-or-later
// The picture beside a finding of `check` that the part, or its region, is the wrong way round.
#pragma once

#include <string>

#include "geometry/mesh/mesh.hpp"
#include "machine/collision/cell.hpp"

namespace millpose {

/// A point, in W, whose normal looks away from the arm or whose tool comes from below.
struct WrongSide {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ(), tool_axis = Eigen::Vector3d::UnitZ();  ///< unit
  bool away = false, below = false;
};

/// An SVG: base, shoulder, the part's outline and the point with normal and tool as they are seen along the
/// horizontal, across the plane through axis 1 and the point. Colours are those of the page's style.
/// A pure function of its arguments; empty part: without an outline.
std::string SideView(const Cell& cell, const Mesh& part, const WrongSide& wrong);

}  // namespace millpose
