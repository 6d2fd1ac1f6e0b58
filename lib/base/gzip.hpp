// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace millpose {

/// Bytes as a member of a gzip file (RFC 1952); several behind each other are a file, too. The same bytes
/// give the same member on every run.
std::string Gzip(std::string_view bytes);

/// What the members of a gzip file hold; empty for anything else, damaged ones among them, and for what would
/// be more than 200 times as long as the file: Gzip() makes a plan to a third.
std::optional<std::string> Gunzip(std::string_view file);

/// Bytes as a zlib stream (RFC 1950).
std::string ZlibBytes(std::string_view bytes);

}  // namespace millpose
