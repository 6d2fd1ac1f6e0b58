// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "base/byte_sink.hpp"

namespace millpose {

/// WriteFileAtomically() (file.hpp) for bytes that need never be in memory together. What `write` throws is
/// passed on.
void WriteFileAtomically(const std::filesystem::path& path, const ByteSource& write);

/// The same for an entry of the open folder `folder` (a descriptor); `path` is what messages name.
void WriteFileAt(int folder, const std::string& name, const std::filesystem::path& path,
                 const ByteSource& write);

}  // namespace millpose
