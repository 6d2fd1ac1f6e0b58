// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/station.hpp"

#include <algorithm>
#include <iterator>

#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {
namespace {

Pose At(const PlanResult& plan, Carries carried, const Pose& at_zero, const ExternalPosition& external) {
  if (external.empty()) return at_zero;
  return Mechanism(plan.external_axes).Moved(carried, external) * at_zero;
}

}  // namespace

Pose BaseAt(const PlanResult& plan, const ExternalPosition& external) {
  return At(plan, Carries::kRobot, plan.X_WB, external);
}

Pose PartAt(const PlanResult& plan, const ExternalPosition& external) {
  return At(plan, Carries::kWorkpiece, plan.X_WP, external);
}

const ExternalPosition& ExternalAt(const PassResult& pass, size_t point) {
  const std::optional<ExternalPosition>& own = pass.points[point].external;
  return own ? *own : pass.external;
}

Pose ToolAt(const PlanResult& plan, const PassResult& pass, size_t point) {
  const ExternalPosition& external = ExternalAt(pass, point);
  const Pose X_PB = PartAt(plan, external).inverse(Eigen::Isometry) * BaseAt(plan, external);
  return X_PB * ForwardFlange(plan.arm, pass.points[point].q) * plan.X_FT;
}

bool MovesAlong(const PassResult& pass) {
  return std::ranges::any_of(pass.points,
                             [](const PlannedPoint& point) { return point.external.has_value(); });
}

bool MovesAlong(const PlanResult& plan) {
  return std::ranges::any_of(plan.passes, [](const PassResult& pass) { return MovesAlong(pass); });
}

std::string PositionText(const std::vector<ExternalAxis>& axes, const ExternalPosition& position) {
  std::vector<std::string> values;
  for (size_t i = 0; i < axes.size(); ++i)
    values.push_back(axes[i].kind == AxisKind::kLinear
                         ? fmt::format("{} {:g} mm", axes[i].name, position[i])
                         : fmt::format("{} {:g} deg", axes[i].name, RadToDeg(position[i])));
  return fmt::format("{}", fmt::join(values, ", "));
}

Pose ToZero(const PlanResult& plan, const ExternalPosition& external) {
  if (external.empty()) return Pose::Identity();
  return Mechanism(plan.external_axes).Moved(Carries::kWorkpiece, external).inverse(Eigen::Isometry);
}

Eigen::Vector3d OnPartAtZero(const PlanResult& plan, const ExternalPosition& external,
                             const Eigen::Vector3d& place) {
  return external.empty() ? place : Eigen::Vector3d(ToZero(plan, external) * place);
}

Pose BaseFromPartAtZero(const PlanResult& plan, const ExternalPosition& external) {
  return ToZero(plan, external) * BaseAt(plan, external);
}

std::vector<SeriesCompliance> CompliancesAt(const PlanResult& plan, const ExternalPosition& external,
                                            std::vector<SeriesCompliance> beside) {
  std::ranges::move(ExternalCompliances(Mechanism(plan.external_axes), external, BaseAt(plan, external)),
                    std::back_inserter(beside));
  return beside;
}

}  // namespace millpose
