// SPDX-License-Identifier: GPL-3.0-or-later
#include "plan/station.hpp"

#include <algorithm>
#include <iterator>

namespace millpose {
namespace {

Pose At(const PlanResult& plan, Carries carried, const Pose& at_zero, const ExternalPosition& external) {
  if (plan.external_axes.empty()) return at_zero;
  return Mechanism(plan.external_axes).Moved(carried, external) * at_zero;
}

}  // namespace

Pose BaseAt(const PlanResult& plan, const ExternalPosition& external) {
  return At(plan, Carries::kRobot, plan.X_WB, external);
}

Pose PartAt(const PlanResult& plan, const ExternalPosition& external) {
  return At(plan, Carries::kWorkpiece, plan.X_WP, external);
}

std::vector<SeriesCompliance> CompliancesAt(const PlanResult& plan, const ExternalPosition& external,
                                            std::vector<SeriesCompliance> beside) {
  std::ranges::move(ExternalCompliances(Mechanism(plan.external_axes), external, BaseAt(plan, external)),
                    std::back_inserter(beside));
  return beside;
}

}  // namespace millpose
