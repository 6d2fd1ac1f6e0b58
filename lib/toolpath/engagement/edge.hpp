// SPDX-License-Identifier: GPL-3.0-or-later
// The cutting edge as slices along the axis (docs/engagement.md).
#pragma once

#include <vector>

#include "toolpath/cutter.hpp"
#include "toolpath/engagement/process_force.hpp"

namespace millpose {

/// What cuts, and how: all that the force of one edge depends on besides where it is.
struct EdgeModel {
  CuttingMaterial material;
  CutterShape cutter;
  int teeth = 1;
  double radial_ratio = 0.3;  ///< force against the envelope's normal ÷ tangential force
  double axial_ratio = 0;     ///< force along the edge's meridian, up ÷ tangential force
};

/// A short piece of the edge's meridian. Its outward normal is sin κ·e_r − cos κ·a, with the lead angle κ:
/// 90° on the cylinder, 0 at the lowest point; e_r points from the axis to the edge, a from tip to holder.
struct EdgeSlice {
  double radius = 0, height = 0;  ///< mm, of its middle, from the axis and above the tip
  double length = 0;              ///< mm, along the meridian: the chip's width
  double sin_lead = 1, cos_lead = 0;
};

/// The meridian from the axis up to `height` (mm above the tip, at most the cutter's length), in slices no
/// taller than `step` (mm) and no longer than an eighth of the corner's quarter circle.
std::vector<EdgeSlice> SliceEdge(const CutterShape& cutter, double height, double step);

/// Force on the tool per mm of edge at a chip thickness h (mm, above 0), N/mm, in the directions of cutting,
/// against the envelope's normal, and up the meridian: k_c1.1·h^(1−m_c) times (1, radial, axial ratio).
Eigen::Vector3d EdgeForce(const EdgeModel& model, double chip);

}  // namespace millpose
