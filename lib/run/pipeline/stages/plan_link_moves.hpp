// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/pipeline/stages/plan_passes.hpp"

namespace millpose {

/// Plans the ways between the pieces of passes whose turns are fixed. Where none is found from one piece to
/// the next, it goes by way of home. A piece that home cannot be reached from, or that cannot be reached from
/// home, is left out (LeaveOut, Obstacle::kAccess), so that it costs neither the others nor the programs;
/// none is where home itself is blocked, which the job has to change. Pieces at different stations have their
/// way by home, where the external axes move; the later of two that no such move leads between is left out.
PlannedLinkMoves PlanAllLinkMoves(const Stations& stations, std::vector<PassResult>& passes,
                                  const LinkMoveOptions& options, const CheckpointStore& checkpoints,
                                  const Execution& execution);

}  // namespace millpose
