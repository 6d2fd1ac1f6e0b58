// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/compensation/compensate.hpp"

namespace millpose {

/// What a compensated plan can be expected to leave of the deflection along the normal: the median, over the
/// points where something is taken out and over arms and forces drawn evenly within the bounds of `options`,
/// of |error after ÷ before|. Empty where nothing is taken out. The same for the same plan on every machine.
std::optional<double> MedianRemains(const CompensationOptions& options, const PlanResult& plan);

}  // namespace millpose
