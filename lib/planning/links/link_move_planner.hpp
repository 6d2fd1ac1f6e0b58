// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stop_token>

#include "planning/links/retract.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

struct LinkMoveOptions {
  RetractOptions leave;
  int max_iterations = 20000;  ///< of RRTConnect; never a clock
  double speed_share = 0.5;    ///< of the joints' largest speed and acceleration, for the duration
  uint64_t seed = 1;
};

/// Where a gap begins or ends: joint angles at home, or on a piece with the tool pose there.
struct LinkMoveEnd {
  int pass = -1, piece = -1;  ///< −1: home
  Joints q = Joints::Zero();
  ExternalPosition external = {};  ///< where the external axes stand then
};

/// Plans the way from one end to another: LIN retract along the tool axis, the straight joint motion or else
/// OMPL's RRTConnect and shortcutting against the whole cell, LIN approach, all re-checked. A gap that cannot
/// be planned says what blocked it. Both ends are at the station that `world` is at. Depends on nothing but
/// its arguments. Throws Interrupted.
LinkMove PlanLinkMove(const World& world, const LinkMoveEnd& from, const LinkMoveEnd& to,
                      const LinkMoveOptions& options, std::stop_token stop);

}  // namespace millpose
