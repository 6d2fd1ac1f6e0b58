// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "plan/plan_result.hpp"

namespace millpose {

/// Leaves a planned piece out of its pass: its points are skipped for `reason`, which `detail` tells in
/// words, and the pieces after it move up by one number.
void LeaveOut(PassResult& pass, int piece, SkipReason reason, const std::string& detail);

}  // namespace millpose
