// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "planning/links/link_move_planner.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// Where programs start and end.
LinkMoveEnd HomeOf(const PlanResult& plan);

/// Where each gap begins and ends, in order: from home to the first piece, between pieces, back home. Empty
/// when there is no piece.
std::vector<std::pair<LinkMoveEnd, LinkMoveEnd>> LinkMoveEnds(const LinkMoveEnd& home,
                                                              const std::vector<PassResult>& passes);

}  // namespace millpose
