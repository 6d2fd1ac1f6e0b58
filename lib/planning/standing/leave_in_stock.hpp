// SPDX-License-Identifier: GPL-3.0-or-later
// The tool against the material as it stands when each piece is milled (docs/stock.md).
#pragma once

#include "base/execution.hpp"
#include "machine/collision/cell.hpp"
#include "planning/result/plan_result.hpp"
#include "planning/result/stock_figures.hpp"
#include "planning/standing/air_feed.hpp"
#include "toolpath/stock/standing_stock.hpp"

namespace millpose {

/// All that a plan cuts with a cutter of that cutting length, in P.
CutsOfTool CutsOf(const PlanResult& plan, const CutterShape& cutter);

/// What milling a plan's pieces comes to.
struct LeftInStock {
  StockFigures figures;  ///< but for the time in air, which depends on feeds
  AirCourse air;
};

/// Mills a plan's pieces in their order out of `stock` (in P) and leaves those out at which what hangs on the
/// tool beside the cutter's cutting length comes nearer to standing material than Clearances::cutting: in the
/// cut, on the straight approach to it and on the retract. What is asked first is the material at the
/// beginning of the piece; where that is met, what the piece itself has left by then. Pieces that are left
/// out leave their material standing. Points between which the tool goes are looked at so densely that no
/// point of it travels more than the clearance between, so that none of them touches. Throws Interrupted.
/// `cutter`: with its cutting length. `air_margin`, mm: of AirCheck, for motions against the material at the
/// beginning of their piece.
LeftInStock LeaveInStock(const Cell& cell, const CutterShape& cutter, double air_margin, StandingStock& stock,
                         const Execution& execution, PlanResult& plan);

}  // namespace millpose
