// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/collision/world.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// Writes into a point of a pass which bodies are nearest to each other there, as found up to
/// kPointClearanceBound.
void TellNearest(const std::optional<Interference>& found, PlannedPoint& point, PassResult& pass);

}  // namespace millpose
