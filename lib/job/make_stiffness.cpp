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

}  // namespace millpose
