// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/tool_axis.hpp"

#include <fmt/format.h>

#include "base/error.hpp"

namespace millpose {

Eigen::Vector3d ToolAxisAt(const ToolAxisOptions& options, const Eigen::Vector3d& position,
                           const Eigen::Vector3d& normal) {
  if (options.rule == AxisRule::kNormal) return normal;
  if (options.rule == AxisRule::kFixed) return options.direction;
  if (options.rule == AxisRule::kWall) {
    const Eigen::Vector3d along = options.direction - options.direction.dot(normal) * normal;
    constexpr double kFlat = 0.0175;  // sine of 1°: a floor, not a wall
    if (!(along.norm() > kFlat))
      throw InputError({}, fmt::format("toolpath.tool_axis: no wall at ({:.3f}, {:.3f}, {:.3f}) mm in the "
                                       "workpiece frame: the surface faces along direction; take it out of "
                                       "toolpath.region",
                                       position.x(), position.y(), position.z()));
    return along.normalized();
  }
  Eigen::Vector3d way = options.point - position;
  way -= way.dot(options.direction) * options.direction;
  if (!(way.norm() > 1e-6))
    throw InputError({},
                     fmt::format("toolpath.tool_axis: the path passes through the point or line that the "
                                 "axis is taken from, at ({:.3f}, {:.3f}, {:.3f}) mm in the workpiece frame",
                                 position.x(), position.y(), position.z()));
  way.normalize();
  return options.rule == AxisRule::kToward ? way : Eigen::Vector3d(-way);
}

}  // namespace millpose
