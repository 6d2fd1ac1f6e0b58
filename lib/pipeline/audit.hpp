// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <stop_token>

#include "cell/world.hpp"
#include "plan/plan_result.hpp"
#include "pose/scorer.hpp"
#include "report/report.hpp"
#include "surface/mesh.hpp"

namespace millpose {

/// Recomputes the figures of summary.json's `audit` from the finished plan. `mesh` is the workpiece in P.
/// Interference is looked for again, pose by pose, with nothing remembered.
AuditFigures Audit(const PlanResult& plan, const Mesh& mesh, const World& world,
                   const AdmissibleBounds& bounds, int threads, std::stop_token stop);

}  // namespace millpose
