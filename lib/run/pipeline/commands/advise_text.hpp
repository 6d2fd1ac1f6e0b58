// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "run/pipeline/commands/advise.hpp"

namespace millpose {

/// For people: lines that stand below those of a check.
std::string ToText(const OperationAdvice& advice);

/// As JSON; keys name their units.
std::string ToJson(const OperationAdvice& advice);

}  // namespace millpose
