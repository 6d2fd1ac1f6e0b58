// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/byte_sink.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// The bytes of Serialise(), pass by pass.
void WritePlan(const PlanResult& result, int threads, const ByteSink& sink);

}  // namespace millpose
