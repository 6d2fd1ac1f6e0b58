// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "base/execution.hpp"
#include "planning/compensation/compensate.hpp"
#include "planning/external/stations.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// A piece in the way of which something is where it is commanded.
struct BlockedPiece {
  size_t pass, piece;  ///< indices, of the pass in the plan and of the piece in the pass
  std::string why;     ///< "something comes too near", part of a sentence
};

/// Checks the straight motions between a plan's commanded poses, and those to and from the retracts, for
/// interference as cuts are checked: the first of each piece that is not free. By `reserve` (mm) they may
/// fall short of the clearances, as in verification: the arm as it is stands beside the one that poses were
/// chosen with. Throws Interrupted.
std::vector<BlockedPiece> BlockedWhereCommanded(const Stations& stations, double swept_resolution,
                                                double reserve, const Execution& execution,
                                                const PlanResult& plan);

/// The same; a piece in which one is not free runs without its shifts (LeaveNominal); what was in the way is
/// returned, one sentence a piece.
std::vector<std::string> KeepCommandedFree(const Stations& stations, const CompensationOptions& options,
                                           double swept_resolution, const Execution& execution,
                                           PlanResult& plan);

/// Leaves out such pieces, whose points get `reason` and `why`. Returns how many.
size_t LeaveOutPieces(const std::vector<BlockedPiece>& pieces, Infeasibility reason, PlanResult& plan);

}  // namespace millpose
