// SPDX-License-Identifier: GPL-3.0-or-later
// The adapter to OMPL: a way through joint space that touches nothing. Only gaps/*.cpp include it.
#pragma once

#include <stop_token>

#include "base/random.hpp"
#include "machine/collision/world.hpp"
#include "planning/links/retract.hpp"

namespace millpose {

struct RouteOptions {
  JointLimits limits;
  int max_iterations = 0;      ///< of RRTConnect
  double resolution = 0.5;     ///< mm, of the swept check
  double clearance_share = 1;  ///< of the clearances, see Checker
  double speed_share = 1;      ///< of the joints' speeds and accelerations, for the duration
  std::stop_token stop = {};
};

/// Corners of a path of straight joint motions from one pose to another, both included.
struct JointRoute {
  std::vector<Joints> corners;  ///< empty when there is none
  std::string problem;          ///< then: what was in the way
  long long poses_checked = 0;  ///< for interference
};

/// A way from `from` to `to` in Phase::kFree: every corner keeps the clearances, every motion between them as
/// Checker::Between promises. The straight motion is tried first, then RRTConnect and shortcutting with
/// random numbers of `random` alone.
JointRoute FindRoute(const World& world, const Joints& from, const Joints& to, const RouteOptions& options,
                     RandomStream random);

}  // namespace millpose
