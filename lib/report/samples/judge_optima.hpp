// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "planning/external/stations.hpp"
#include "planning/pose/search.hpp"
#include "planning/result/plan_result.hpp"
#include "report/report.hpp"

namespace millpose {

/// Looks for every point's own optimum exhaustively, on a grid of `step` (rad), and notes it as
/// `exhaustive_optimum`; says how near the plan's genetic algorithm came, and how near it comes when it
/// starts without a table. Fills the `ga_` figures. Points that the cutter would gouge at are left out.
void JudgeOptima(const Stations& stations, const GeneticOptions& genetic, double step,
                 const Execution& execution, PlanResult& plan, AuditFigures& figures);

}  // namespace millpose
