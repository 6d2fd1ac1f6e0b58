// SPDX-License-Identifier: GPL-3.0-or-later
// Settings of compliance and weight → values of the stiffness module.
#include "job/assemble.hpp"
#include "machine/robot/make_pose.hpp"

namespace millpose {

std::vector<SeriesCompliance> MakeCompliances(const CellSettings& settings) {
  std::vector<SeriesCompliance> elements;
  const auto add = [&](const ComplianceSettings& from) {
    SeriesCompliance element;
    element.name = from.name;
    element.link = from.link;
    element.X_LK = MakePose(from.pose);
    element.C.diagonal() << from.translational, from.rotational;
    for (size_t i = 0; i < from.matrix.size(); ++i)
      element.C.row(static_cast<Eigen::Index>(i)) = from.matrix[i];
    elements.push_back(element);
  };
  std::ranges::for_each(settings.compliances, add);
  std::ranges::for_each(settings.tool.compliances, add);
  return elements;
}

std::vector<SeriesCompliance> MakeCompliancesAtHome(const CellSettings& settings) {
  std::vector<SeriesCompliance> elements = MakeCompliances(settings);
  const Mechanism mechanism({settings.external_axes.begin(), settings.external_axes.end()});
  const Pose X_WB = mechanism.Moved(Carries::kRobot, mechanism.Home()) * MakePose(settings.base_in_world);
  std::ranges::move(ExternalCompliances(mechanism, mechanism.Home(), X_WB), std::back_inserter(elements));
  return elements;
}

std::optional<GravityModel> MakeGravity(const CellSettings& settings) {
  if (!settings.gravity) return std::nullopt;
  GravityModel model;
  model.reference = settings.gravity->reference;
  for (const MassSettings& from : settings.gravity->masses)
    model.masses.push_back({from.name, from.link, from.mass, from.centre});
  model.counterbalance_given = settings.gravity->counterbalance_torque.has_value();
  model.counterbalance = {settings.gravity->counterbalance_torque.value_or(0.0),
                          settings.gravity->counterbalance_zero};
  constexpr double kGravity = 9810;  // mm/s², along −z of W
  model.gravity = MakePose(settings.base_in_world).linear().transpose() * Eigen::Vector3d(0, 0, -kGravity);
  return model;
}

GearModel MakeGearModel(const CellSettings& settings) {
  GearModel model;
  LostMotion& lost = model.lost;
  lost.CountAs({GearMatrix(settings.arm), Joints::Zero()});
  const std::optional<Vector6>& width = settings.arm.lost_motion;
  if (width) lost.width.head<6>() = *width;
  std::fill_n(model.known.begin(), 6, width.has_value());
  if (const std::optional<GearErrorSettings>& error = settings.arm.gear_error)
    model.error = GearError{error->amplitude, error->periods, Joints::Zero()};
  for (size_t i = 0; i < settings.external_axes.size(); ++i) {
    const ExternalAxisSettings& axis = settings.external_axes[i];
    const auto gear = static_cast<Eigen::Index>(6 + i);
    lost.width[gear] = axis.lost_motion.value_or(0);
    model.known[6 + i] = axis.lost_motion.has_value();
    if (axis.kind == AxisKind::kLinear) lost.dead_zone[gear] = kLinearDeadZone;
  }
  if (const std::optional<GravityModel> gravity = MakeGravity(settings);
      gravity && settings.arm.gear_friction) {
    lost.friction.head<6>() = *settings.arm.gear_friction;
    model.weights = GearWeights{gravity->masses, gravity->counterbalance, gravity->gravity};
  }
  return model;
}

}  // namespace millpose
