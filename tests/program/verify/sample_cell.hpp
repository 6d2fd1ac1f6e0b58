// SPDX-License-Identifier: GPL-3.0-or-later
// A cell around the sample plan: tool stack, platform, the wall that is milled.
#pragma once

#include "machine/collision/world.hpp"
#include "program/verify/verify.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {

Cell SampleCell(const PlanResult& plan);
VerifyOptions SampleOptions(const PlanResult& plan);

}  // namespace millpose
