// SPDX-License-Identifier: GPL-3.0-or-later
// Why a closed ring costs much: a stripe of interference that it cannot cross.
#pragma once

#include "planning/pass/segment_planner.hpp"

namespace millpose {

/// The search for a closed ring, as it stands when its answer is free.
struct ClosedSearch {
  const PassContext& context;
  const LadderProblem& problem;  ///< what interferes is pruned
  const CandidateGraph& graph;
  const Sequence& sequence;  ///< closed and free
  double unbarred = 0;       ///< cost of the first answer, when nothing had been pruned
};

/// One sentence where interference makes the closed ring dearer by more than 2 %, and leaving it open would
/// take more than a third of that off: the bodies, at how many points, the rotations that they bar beside the
/// point where the ring loses most, and the three costs. Else empty. What is pruned is what was met on
/// the way: costs of the ring left open are about right, not proven.
std::string ExplainStripe(const ClosedSearch& search);

}  // namespace millpose
