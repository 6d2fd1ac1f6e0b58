// SPDX-License-Identifier: GPL-3.0-or-later
// Files outside of output folders: what people wrote (a cell, a job), and single results beside it. There is
// one way to write them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace millpose {

/// Where the links that `path` may be lead, the last of them to what need not exist. Throws InputError for
/// links that go round.
std::filesystem::path BehindLinks(const std::filesystem::path& path);

/// Puts `bytes` in the place of a file, or makes it: readers see the old content or the new, never a part,
/// and a link stays one. Mode, owner and access list stay those of the file; a new one is 0644. The bytes are
/// on the disk when it returns; where it fails the old file stands, or already the new one, whole. What runs
/// that were killed left unfinished beside the file goes away first. Throws InputError: also for what is
/// there and no regular file, and for an owner that cannot be kept.
void WriteLooseFile(const std::filesystem::path& path, std::string_view bytes);

/// Changes a file that people wrote; `change` makes the new content of the old one. A file that stays as it
/// is is not written. Throws as WriteLooseFile() and what `change` throws.
void EditLooseFile(const std::filesystem::path& path,
                   const std::function<std::string(const std::string& text)>& change);

}  // namespace millpose
