// SPDX-License-Identifier: GPL-3.0-or-later
// Where base and part of a plan stand with the external axes somewhere (docs/external-axes.md).
#pragma once

#include "machine/stiffness/series.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// Where the robot's base and the part stand in W with the external axes at `external`: `plan.X_WB` and
/// `plan.X_WP` themselves where `external` is empty: where the cell has none.
Pose BaseAt(const PlanResult& plan, const ExternalPosition& external);
Pose PartAt(const PlanResult& plan, const ExternalPosition& external);

/// Where the external axes are at point `point` of a pass: its own position, or that of the whole pass.
const ExternalPosition& ExternalAt(const PassResult& pass, size_t point);

/// Where the tool stands on the part at point `point` of a pass: tip and z to the holder, P.
Pose ToolAt(const PlanResult& plan, const PassResult& pass, size_t point);

/// Whether external axes move along a pass.
bool MovesAlong(const PassResult& pass);
/// Whether they do along any pass.
bool MovesAlong(const PlanResult& plan);

/// "rail 1500 mm, table 30 deg".
std::string PositionText(const std::vector<ExternalAxis>& axes, const ExternalPosition& position);

/// Brings places and directions in W on the part, with the external axes at `external`, to where they are
/// with all of them at 0.
Pose ToZero(const PlanResult& plan, const ExternalPosition& external);
/// `place` itself where `external` is empty.
Eigen::Vector3d OnPartAtZero(const PlanResult& plan, const ExternalPosition& external,
                             const Eigen::Vector3d& place);
/// Where the robot's base then stands as seen from there.
Pose BaseFromPartAtZero(const PlanResult& plan, const ExternalPosition& external);

/// All that yields beside the joints with the external axes at `external`: `beside`, which the cell has
/// anyway, and the external axes.
std::vector<SeriesCompliance> CompliancesAt(const PlanResult& plan, const ExternalPosition& external,
                                            std::vector<SeriesCompliance> beside);

}  // namespace millpose
