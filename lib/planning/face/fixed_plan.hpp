// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "planning/external/stations.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// A plan's points with one rotation about the tool axis (rad), and the tool axes that they have: what any
/// CAM system can program. Every pass is on the branch that serves all its points and has the least sum of
/// the objective. Motions between passes, interference and leads' own rules are not looked at. Empty where a
/// pass is not served; `why` then says which. `stations` as of Stations::AtOwnAxis.
std::optional<PlanResult> AtFixedRotation(const PlanResult& plan, const Stations& stations, double rotation,
                                          std::string* why = nullptr);

}  // namespace millpose
