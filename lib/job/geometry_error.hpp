// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "job/config/cell_settings.hpp"
#include "planning/result/plan_result.hpp"
#include "report/geometry.hpp"

namespace millpose {

/// What `arm.deviations` do to the cut points of passes from `finished_from` on, commanded as the plan has
/// them (`taken_out`: for this arm); none where the arm has none or nothing is cut. The frame measured with
/// the arm takes out the shift and turn of the part that leave the least squares along the normals.
std::optional<GeometryFigures> ErrorOfGeometry(const ArmSettings& arm, const PlanResult& plan,
                                               int finished_from, bool taken_out);

}  // namespace millpose
