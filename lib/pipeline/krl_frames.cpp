// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/krl_frames.hpp"

#include "base/error.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "pipeline/assemble.hpp"

namespace millpose {
namespace {

constexpr double kUpright = 1 * kRadPerDeg;  // a base that was levelled stands within

Eigen::Vector3d DirectionOf(const std::string& name) {
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(name.back() - 'x');
  return name.starts_with('-') ? Eigen::Vector3d(-axis) : axis;
}

}  // namespace

Pose RobotBaseInWorld(const ControllerSettings& controller) {
  const Pose robroot = MakePose(controller.robroot.value_or(PoseSettings{}));
  if (!controller.ersysroot) return robroot;
  const RailSettings& rail = *controller.ersysroot;
  Pose carriage = Pose::Identity();
  carriage.translation() =
      controller.external_axes.at(static_cast<size_t>(rail.axis) - 1) * DirectionOf(rail.direction);
  return MakePose(rail.pose) * carriage * robroot;
}

void CheckGravity(const CellSettings& cell, const ControllerSettings& controller) {
  const Eigen::Vector3d up = MakePose(cell.base_in_world).linear().row(2);
  const Eigen::Vector3d believed = RobotBaseInWorld(controller).linear().row(2);
  const double apart = Atan2(up.cross(believed).norm(), up.dot(believed));
  if (apart <= kUpright) return;
  throw InputError(
      Place{cell.file},
      fmt::format(
          "controllers.krl: base_in_world and robroot turn the robot by {:.1f} deg against each other, "
          "seen from gravity; {}: the controller's $ROBROOT expected (ceiling C 180, wall B 90), which "
          "its own model of weights uses",
          apart * kDegPerRad, controller.robroot ? "robroot must agree" : "robroot is missing"));
}

}  // namespace millpose
