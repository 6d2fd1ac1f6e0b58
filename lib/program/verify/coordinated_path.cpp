// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/coordinated_path.hpp"

#include "machine/collision/coordinated_checker.hpp"
#include "machine/collision/station_path.hpp"
#include "machine/robot/position_between.hpp"

namespace millpose {

std::optional<Interference> FindOnCoordinatedMotion(const World& at_zero, const CoordinatedPath& way,
                                                    const CoordinatedClearance& clearance) {
  CoordinatedChecker checker(at_zero, clearance.share, clearance.reserve);
  const auto pose = [&](const std::pair<double, Joints>& at) {
    return CoordinatedPose{at.second, PositionBetween(way.from, way.to, at.first)};
  };
  for (size_t i = 1; i < way.joints.size(); ++i)
    if (const auto seen = checker.BlockedBetween(pose(way.joints[i - 1]), pose(way.joints[i]),
                                                 Phase::kCutting, clearance.resolution))
      return checker.Measure(*seen);
  return StationPath(at_zero, way.joints.front().second, clearance.resolution)
      .StandingBetween(way.from, way.to);
}

}  // namespace millpose
