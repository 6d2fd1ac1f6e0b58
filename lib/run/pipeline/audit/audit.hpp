// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "base/execution.hpp"
#include "geometry/mesh/mesh.hpp"
#include "geometry/registration/bending.hpp"
#include "machine/collision/cell.hpp"
#include "planning/pose/scorer.hpp"
#include "planning/result/plan_result.hpp"
#include "report/report.hpp"
#include "toolpath/cutter.hpp"

namespace millpose {

/// What a plan is held to.
struct AuditRules {
  AdmissibleBounds bounds;
  CutterShape cutter;
  double resolution = 0;  ///< mm: what a motion between two points may miss of a clearance
  /// Where the programs take the arm's deviations out: commanded motions are then those of the arm as it is.
  std::optional<ArmDeviations> deviations = {};
  std::optional<PartBending> bending = {};  ///< of a bent part
};

/// Recomputes the figures of summary.json's `audit` from the finished plan, but for those of the optima
/// (JudgeOptima). `mesh` is the workpiece in P,
/// `cell` has it among its bodies. Contact and clearance are looked for by the judge (lib/audit), which
/// shares nothing with the checker that the plan was made with; each motion is held to the share of the
/// clearances that the plan states for it, less the resolution.
AuditFigures Audit(const PlanResult& plan, const Mesh& mesh, const Cell& cell, const AuditRules& rules,
                   const Execution& execution);

/// What of it is wrong, one sentence each; empty when all is well.
std::vector<std::string> Findings(const AuditFigures& figures);

}  // namespace millpose
