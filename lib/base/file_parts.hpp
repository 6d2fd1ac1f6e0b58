// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

#include "base/byte_sink.hpp"

namespace millpose {

/// When written bytes are on the disk: before the call returns, or when the system comes to it. Then a power
/// cut may leave an empty or torn file: for what says itself whether it is whole, and can be made again.
enum class OnDisk : uint8_t { kNow, kLater };

/// WriteFileAtomically() (file.hpp) for bytes that need never be in memory together. What `write` throws is
/// passed on.
void WriteFileAtomically(const std::filesystem::path& path, const ByteSource& write);

/// The same for an entry of the open folder `folder` (a descriptor); `path` is what messages name.
void WriteFileAt(int folder, const std::string& name, const std::filesystem::path& path,
                 const ByteSource& write, OnDisk on_disk = OnDisk::kNow);

}  // namespace millpose
