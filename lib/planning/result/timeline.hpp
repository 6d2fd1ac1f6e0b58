// SPDX-License-Identifier: GPL-3.0-or-later
// Where the arm is at which time of a plan: what report.html plays. Made by lib/program/make_timeline.hpp.
#pragma once

#include <vector>

#include "machine/robot/mechanism.hpp"

namespace millpose {

/// What the motion that leads to an instant does. kMissing: a gap that could not be planned; the arm leaps.
/// kExternal: the external axes move, the arm stands still.
enum class RunPart : uint8_t { kCut, kLead, kApproach, kRetract, kLinkMove, kMissing, kExternal };

/// One instant; between two of them the joints turn evenly, near enough to be looked at.
struct RunInstant {
  double time = 0;  ///< s, from the beginning; never falls
  Joints q = Joints::Zero();
  ExternalPosition external;                      ///< where the external axes stand
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  ///< of the tool, in W, mm
  RunPart stretch = RunPart::kLinkMove;
  int pass = -1;   ///< index into PlanResult::passes, of the pass that is milled or led to; −1: to home
  int point = -1;  ///< of it, where the instant is a planned point's; else −1
};

/// In the order of execution; empty where nothing was planned.
using Timeline = std::vector<RunInstant>;

}  // namespace millpose
