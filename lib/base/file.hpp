// SPDX-License-Identifier: GPL-3.0-or-later
// The only place that opens files. Readers elsewhere take bytes and a name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace millpose {

/// The whole content of a regular file. Throws InputError when it is missing, not a regular file, unreadable,
/// or larger than `max_bytes`.
std::string ReadFile(const std::filesystem::path& path, size_t max_bytes = size_t{4} << 30);

/// Writes `bytes` to a temporary file beside `path` and renames it: readers see the old content or the new,
/// never a part. Throws InputError when the folder cannot be written.
void WriteFileAtomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace millpose
