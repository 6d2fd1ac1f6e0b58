// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/result/plan_result.hpp"

namespace millpose {

/// The hash of every field of passes.
std::string KeyOf(const std::vector<PassResult>& passes, int threads);

/// The hash of gaps but for how often interference was asked about: a body near one changes that where it
/// does not change the way.
std::string KeyOf(std::vector<LinkMove> gaps);

/// Of every field of a plan but the hash of its inputs, which names it and says nothing of it, and what its
/// gaps took to plan.
std::string KeyOf(const PlanResult& plan, int threads);

}  // namespace millpose
