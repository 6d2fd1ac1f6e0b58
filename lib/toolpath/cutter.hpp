// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/mesh.hpp"

namespace millpose {

/// A cutter that turns about its axis: a disc of radius R − r with a torus of radius r around it. Flat: r =
/// 0; ball: r = R; bull-nose: between. mm.
struct CutterShape {
  double radius = 0;         ///< R
  double corner_radius = 0;  ///< r, 0..R
  double length = 0;         ///< of the part that is looked at, from the tip up

  bool IsBall() const { return radius > 0 && corner_radius == radius; }
};

/// Where the tip is (the lowest point on the axis) when the cutter touches a surface at `contact` with
/// outward normal `normal` (unit vectors; `axis` from tip to holder, less than 90° from the normal): contact
/// + r normal − r axis + (R − r) w, w the unit vector along the normal's part across the axis (0 when there
/// is none: then the whole flat touches and the tip is put at the contact).
Eigen::Vector3d TipAtContact(const CutterShape& cutter, const Eigen::Vector3d& contact,
                             const Eigen::Vector3d& normal, const Eigen::Vector3d& axis);

/// The other way: what the cutter touches when its tip is there.
Eigen::Vector3d ContactAtTip(const CutterShape& cutter, const Eigen::Vector3d& tip,
                             const Eigen::Vector3d& normal, const Eigen::Vector3d& axis);

/// How far the contact lies from the axis, mm: that, times the spindle's speed, is the cutting speed there.
double ContactRadius(const CutterShape& cutter, const Eigen::Vector3d& normal, const Eigen::Vector3d& axis);

}  // namespace millpose
