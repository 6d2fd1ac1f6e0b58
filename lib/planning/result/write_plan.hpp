// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/byte_sink.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// The bytes of plan.cbor.gz: those of Serialise() as members of a gzip file, one for every pass and one for
/// what stands before and behind these.
void WritePlan(const PlanResult& result, int threads, const ByteSink& sink);

}  // namespace millpose
