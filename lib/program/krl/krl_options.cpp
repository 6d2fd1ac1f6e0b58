// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/krl/krl_options.hpp"

#include "base/trig.hpp"
#include "machine/robot/make_pose.hpp"
#include "program/external_axes.hpp"

namespace millpose {
namespace {

constexpr double kAlong = 1 * kRadPerDeg;  // a measured rail lies within, along the direction of its root

/// The coupled axes that carry the robot. One that the cell does not plan can be nothing else.
std::vector<const ControllerAxis*> Carriages(const PostSettings& settings) {
  std::vector<const ControllerAxis*> found;
  for (const ControllerAxis& axis : settings.controller_axes) {
    const auto index = AxisOf(settings, axis);
    if (!axis.coupled) continue;
    if (!index || settings.mechanism.axes()[*index].carries == Carries::kRobot) found.push_back(&axis);
  }
  return found;
}

bool CountsInTable(const PostSettings& settings) {
  return std::ranges::any_of(settings.controller_axes, [&](const ControllerAxis& axis) {
    const auto index = AxisOf(settings, axis);
    return axis.coupled && index && settings.mechanism.axes()[*index].carries == Carries::kWorkpiece;
  });
}

/// The cell's world in the controller's.
Pose WorldInWorld(const KrlOptions& options, const PostSettings& settings) {
  return KrlBase(options, settings) * settings.X_WB.inverse();
}

/// Why the carriage does not move as ersysroot says.
std::string WhyNotAlong(const KrlOptions& options, const PostSettings& settings, const ExternalAxis& axis) {
  const Eigen::Vector3d believed =
      MakePose(options.ersysroot->pose).linear() * DirectionOf(options.ersysroot->direction);
  const Eigen::Vector3d real = WorldInWorld(options, settings).linear() * axis.direction;
  const double apart = Atan2(believed.cross(real).norm(), believed.dot(real));
  if (axis.kind == AxisKind::kLinear && apart <= kAlong) return {};
  return fmt::format(
      "controllers.krl.ersysroot: the cell's axis {} {} with direction {} of $ERSYSROOT; expected: a linear "
      "axis "
      "along that direction, growing as the controller counts",
      axis.name,
      axis.kind == AxisKind::kRotary ? "turns" : fmt::format("makes {:.1f} deg", apart * kDegPerRad),
      WordOf(kFrameAxisWords, options.ersysroot->direction));
}

}  // namespace

Pose KrlRobroot(const KrlOptions& options) { return MakePose(options.robroot.value_or(PoseSettings{})); }

std::string KrlCarriage(const PostSettings& settings) {
  const std::vector<const ControllerAxis*> carriages = Carriages(settings);
  return carriages.empty() ? std::string() : carriages.front()->name;
}

Pose KrlBase(const KrlOptions& options, const PostSettings& settings, const ExternalPosition& external) {
  Pose robroot = KrlRobroot(options);
  if (!options.ersysroot) return robroot;
  const KrlRail& rail = *options.ersysroot;
  Pose carriage = Pose::Identity();
  for (const ControllerAxis* axis : Carriages(settings))
    carriage.translation() += ValueOf(settings, *axis, external) * DirectionOf(rail.direction);
  return MakePose(rail.pose) * carriage * robroot;
}

double KrlTilt(const KrlOptions& options, const PostSettings& settings) {
  const Eigen::Vector3d up = settings.X_WB.linear().row(2);
  const Eigen::Vector3d believed = KrlBase(options, settings).linear().row(2);
  return Atan2(up.cross(believed).norm(), up.dot(believed));
}

Pose KrlTableFrame(const KrlOptions& options, const PostSettings& settings,
                   const ExternalPosition& external) {
  const KrlTable& table = *options.external_base;
  Pose at_zero = MakePose(table.root) * MakePose(table.flange);
  if (external.empty()) return at_zero;
  const Pose X_KW = WorldInWorld(options, settings);
  return X_KW * settings.mechanism.Moved(Carries::kWorkpiece, CoupledPart(settings, external)) *
         X_KW.inverse() * at_zero;
}

Pose KrlBaseValue(const KrlOptions& options, const PostSettings& settings, const ExternalPosition& external,
                  const Pose& X_BP) {
  const Pose X_KP = KrlBase(options, settings, external) * X_BP;
  return options.external_base ? KrlTableFrame(options, settings, external).inverse() * X_KP : X_KP;
}

Pose KrlBaseFrame(const KrlOptions& options, const PostSettings& settings, const ExternalPosition& external,
                  const Pose& value) {
  const Pose X_BK = KrlBase(options, settings, external).inverse();
  return options.external_base ? X_BK * KrlTableFrame(options, settings, external) * value : X_BK * value;
}

std::string KrlWhyNotWithAxes(const KrlOptions& options, const PostSettings& settings) {
  const std::vector<const ControllerAxis*> carriages = Carriages(settings);
  if (!carriages.empty() && !options.ersysroot)
    return fmt::format(
        "controllers.krl.ersysroot: is missing; expected: $ERSYSROOT of {}, which is coupled and "
        "carries the robot",
        carriages.front()->name);
  if (options.ersysroot && carriages.size() != 1)
    return fmt::format(
        "controllers.krl.ersysroot: {} of external_axes are coupled and carry the robot; expected: "
        "one",
        carriages.size());
  if (options.external_base && !CountsInTable(settings))
    return "controllers.krl.external_base: has no effect here: no axis of external_axes is coupled and "
           "carries "
           "the workpiece";
  if (!options.external_base && CountsInTable(settings))
    return "controllers.krl.external_base: is missing; expected: number and root of the kinematic whose axis "
           "is "
           "coupled and carries the workpiece";
  if (options.base_number > 0 && !settings.mechanism.axes().empty())
    return "controllers.krl.base_number: one frame does not do where external axes are planned; leave it "
           "out: "
           "programs then state $BASE themselves";
  const auto planned = carriages.empty() ? std::nullopt : AxisOf(settings, *carriages.front());
  return planned ? WhyNotAlong(options, settings, settings.mechanism.axes()[*planned]) : std::string();
}

}  // namespace millpose
