// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/ladder/refine.hpp"
#include "planning/pose/scorer.hpp"

namespace millpose {

/// Makes the joints of a piece continuous and moves each by as few full revolutions as bring all of the piece
/// within the bounds, the end of a closed one too. False when no number of turns does.
bool Unwind(std::span<PathNode> path, bool closed, const AdmissibleBounds& bounds);

}  // namespace millpose
