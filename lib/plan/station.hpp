// SPDX-License-Identifier: GPL-3.0-or-later
// Where base and part of a plan stand with the external axes somewhere (docs/external-axes.md).
#pragma once

#include "plan/plan_result.hpp"
#include "stiffness/series.hpp"

namespace millpose {

/// Where the robot's base and the part stand in W with the external axes at `external`: `plan.X_WB` and
/// `plan.X_WP` themselves where the cell has none.
Pose BaseAt(const PlanResult& plan, const ExternalPosition& external);
Pose PartAt(const PlanResult& plan, const ExternalPosition& external);

/// All that yields beside the joints with the external axes at `external`: `beside`, which the cell has
/// anyway, and the external axes.
std::vector<SeriesCompliance> CompliancesAt(const PlanResult& plan, const ExternalPosition& external,
                                            std::vector<SeriesCompliance> beside);

}  // namespace millpose
