// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace millpose {

/// Bytes in fewer, by zstd at its default level; for what only the same program reads again.
std::string Packed(std::string_view bytes);

/// What was packed; empty for bytes that Packed() did not make, damaged ones among them.
std::optional<std::string> Unpacked(std::string_view packed);

}  // namespace millpose
