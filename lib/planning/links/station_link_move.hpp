// SPDX-License-Identifier: GPL-3.0-or-later
// Ways between pieces that are milled at different stations (docs/external-axes.md).
#pragma once

#include "planning/external/stations.hpp"
#include "planning/links/link_move_planner.hpp"

namespace millpose {

/// The way from one end to another, each at its own station. Where the stations differ it goes by home, and
/// the external axes move from one to the other while the arm stands there; one that cannot be planned says
/// what blocked it. Depends on nothing but its arguments. Throws Interrupted.
LinkMove PlanStationLinkMove(const Stations& stations, const LinkMoveEnd& from, const LinkMoveEnd& to,
                             const LinkMoveOptions& options, std::stop_token stop);

/// The way home from one piece, then the way from there to the next, both at one station.
LinkMove ByWayOfHome(const LinkMove& out, const LinkMove& in);

}  // namespace millpose
