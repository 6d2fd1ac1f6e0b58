// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "base/units.hpp"
#include "geometry/mesh/mesh.hpp"
#include "toolpath/budget.hpp"
#include "toolpath/cam/cam_path.hpp"

namespace millpose {

/// How a CAM path becomes passes. mm, rad, mm/s.
struct CamImportOptions {
  double spacing = 5;  ///< largest distance of neighbouring points; more are put on the straight ways
  double crease = DegToRad(30);  ///< of the mesh's normals
  double ball_radius = 0;        ///< of a ball cutter: its contact is looked for around the ball's centre
  double contact_distance =
      1;                 ///< with a mesh: points farther from it at a pass's ends are lead-in and lead-out
  double feed_rate = 0;  ///< where the path gives none
  Eigen::Vector3d rotation_reference = Eigen::Vector3d::UnitZ();
  PointBudget budget;
};

struct CamImportReport {
  size_t passes = 0, points = 0, leads = 0;
  std::optional<double> median_distance, largest_distance;  ///< of cut points from the mesh, mm
  size_t turns_on_the_spot = 0;  ///< where the axis turns without travel a pass ends
};

/// Makes passes from a CAM path, in its own order: a pass is what lies between rapids. With a mesh each point
/// gets the normal of the nearest surface, without one the tool axis serves as normal. Positions and axes are
/// never moved. A pass that ends where it began is closed. Throws InputError when nothing is cut.
Toolpath ImportCamPath(const CamPath& path, const Mesh* mesh, const CamImportOptions& options,
                       CamImportReport* report);

}  // namespace millpose
