// SPDX-License-Identifier: GPL-3.0-or-later
// The only place that opens files. Readers elsewhere take bytes and a name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace millpose {

/// The whole content of a regular file. Throws InputError when it is missing, not a regular file, unreadable,
/// or larger than `max_bytes`.
std::string ReadFile(const std::filesystem::path& path, size_t max_bytes = size_t{4} << 30);

/// Writes `bytes` to a temporary file beside `path` and renames it: readers see the old content or the new,
/// never a part. The bytes are on the disk when it returns; where it fails no temporary file stays.
void WriteFileAtomically(const std::filesystem::path& path, std::string_view bytes);

/// Steps on the file system. All throw InputError with the path and the system's reason.
bool Exists(const std::filesystem::path& path);
void MakeFolders(const std::filesystem::path& folder);
void Rename(const std::filesystem::path& from, const std::filesystem::path& to);
/// The file, or the folder with all that it holds; nothing where there is none.
void RemoveAll(const std::filesystem::path& path);
/// What stands in a folder, sorted; nothing where there is no such folder.
std::vector<std::filesystem::path> EntriesOf(const std::filesystem::path& folder);
/// Waits until names that were made, renamed or removed in the folder are on the disk.
void SyncFolder(const std::filesystem::path& folder);

}  // namespace millpose
