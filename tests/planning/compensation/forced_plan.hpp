// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/compensation/compensate.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {

/// The sample plan, fed along its passes under a force that leans on the wall.
PlanResult Forced(double newtons = 300);

/// Compensation along the normal with everything sure.
CompensationOptions Sure();

}  // namespace millpose
