// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "planning/result/plan_result.hpp"

namespace millpose {

/// Which points count.
using PointFilter = std::function<bool(const PlannedPoint&)>;

/// Whether some points are known to be in material.
bool MaterialIsKnown(const std::vector<PassResult>& passes);

/// The planned cut points; where some are known to be in material only these.
PointFilter Compared(const std::vector<PassResult>& passes);

}  // namespace millpose
