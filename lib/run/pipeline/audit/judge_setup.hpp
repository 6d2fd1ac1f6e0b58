// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "audit/setup.hpp"
#include "machine/collision/cell.hpp"

namespace millpose {

/// The cell as the judge sees it: its own bodies, tessellated from inside, the cutter cut in two where its
/// cutting length ends. The workpiece among the cell's bodies.
audit::Setup MakeJudgeSetup(const Cell& cell);

audit::Angles ToJudge(const Joints& q);
std::vector<audit::Real> ToJudge(const ExternalPosition& position);

}  // namespace millpose
