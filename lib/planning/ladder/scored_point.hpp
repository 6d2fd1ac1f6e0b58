// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "toolpath/infeasibility.hpp"

namespace millpose {

/// A sampled point in some place: what keeps it, or its least objective.
struct ScoredPoint {
  Infeasibility obstacle = Infeasibility::kNone;
  double objective = 0;
};

}  // namespace millpose
