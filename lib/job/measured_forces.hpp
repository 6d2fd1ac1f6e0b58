// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "job/inputs.hpp"
#include "planning/compensation/compensate.hpp"

namespace millpose {

/// The forces of `process.force_csv` (docs/compensation.md) at a plan's points, in W, N. Throws InputError
/// with the file's lines for rows that are not of this plan's points, and for cut points without a row.
PointForces ReadMeasuredForces(const JobInputs& inputs, const PlanResult& plan);

}  // namespace millpose
