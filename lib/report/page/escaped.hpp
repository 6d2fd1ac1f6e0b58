// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace millpose {

/// Text as it may stand in HTML and XML, between tags and in quoted attributes: & < > " as entities, bytes
/// that are no UTF-8 as "?", control characters but line ends as blanks.
std::string Escaped(std::string_view text);

}  // namespace millpose
