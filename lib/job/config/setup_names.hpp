// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "job/config/config.hpp"

namespace millpose {

/// The setup of each operation of a job, in their order; empty names where it has no setups, nothing where it
/// has no operations. Throws InputError as OutlineOf() does.
std::vector<std::string> SetupNames(std::string_view yaml, const std::string& name,
                                    const std::vector<Override>& overrides = {});

}  // namespace millpose
