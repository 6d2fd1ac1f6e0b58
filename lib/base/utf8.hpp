// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string_view>

namespace millpose {

/// Bytes of the character that `text` begins with in valid UTF-8 (RFC 3629); 0 where it begins with none.
/// `text` is not empty.
size_t Utf8Length(std::string_view text);

}  // namespace millpose
