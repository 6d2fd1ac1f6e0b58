// SPDX-License-Identifier: GPL-3.0-or-later
// Where the tool comes from, in place of the surface's normal.
#pragma once

#include <Eigen/Dense>

namespace millpose {

enum class AxisRule : uint8_t {
  kNormal,  ///< along the surface's normal
  kFixed,   ///< the same direction at every point
  kToward,  ///< the holder lies towards a point or line: cavities
  kAway,    ///< the holder lies away from it: outsides
  kWall,    ///< along the surface, as near to a direction as that goes: walls that lean, by the cutter's side
};

/// Frame P. `lead` and `tilt` of the tool path lean the axis from there.
struct ToolAxisOptions {
  AxisRule rule = AxisRule::kNormal;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< of toward and away, mm; of a line any of its points
  Eigen::Vector3d direction =
      Eigen::Vector3d::Zero();  ///< fixed, wall: from tip to holder; else the line's, zero: a point
};

/// The tool axis at a point of the surface, before it leans: a unit vector from tip to holder. Throws
/// InputError at a point on the line, or the point itself, and where a wall would face along its direction:
/// there is none.
Eigen::Vector3d ToolAxisAt(const ToolAxisOptions& options, const Eigen::Vector3d& position,
                           const Eigen::Vector3d& normal);

}  // namespace millpose
