// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace millpose {

/// 32 hexadecimal digits that identify `bytes` (XXH3, 128 bits): for checkpoints and program headers, not
/// against forgery.
std::string Hash(std::string_view bytes);

}  // namespace millpose
