// SPDX-License-Identifier: GPL-3.0-or-later
// Points of a plan, and those that are not cut.
#pragma once

#include <map>

#include "planning/result/plan_result.hpp"

namespace millpose {

/// Leaves a planned piece out of its pass: its points are skipped for `reason`, which `detail` tells in
/// words, and the pieces after it move up by one number.
void LeaveOut(PassResult& pass, int piece, Infeasibility reason, const std::string& detail);

/// All of its points, skipped ones too.
size_t CountPoints(const PlanResult& plan);
size_t CountSkipped(const PassResult& pass);

/// How many points are skipped, by ToString(Obstacle).
std::map<std::string, size_t> SkippedByReason(const PlanResult& plan);

}  // namespace millpose
