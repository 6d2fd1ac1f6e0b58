// SPDX-License-Identifier: GPL-3.0-or-later
// Files outside of output folders: what people wrote (a cell, a job), and single results beside it. There is
// one way to write them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace millpose {

/// Puts `bytes` in the place of a file, or makes it: readers see the old content or the new, never a part.
/// Mode, owner and access list stay those of the file; a new one is 0644. A link is not followed, the file
/// takes its place. The bytes are on the disk when it returns; where it fails the old file stands, or already
/// the new one, whole. What runs that were killed left unfinished in its folder goes away first. Throws
/// InputError: also for what is there and no regular file, and for an owner that cannot be kept.
void WriteLooseFile(const std::filesystem::path& path, std::string_view bytes);

/// Changes a file that people wrote, in the same way, but behind the links that `path` may be, which stay;
/// `change` makes the new content of the old one. A file that stays as it is is not written. Throws as
/// WriteLooseFile() and what `change` throws.
void EditLooseFile(const std::filesystem::path& path,
                   const std::function<std::string(const std::string& text)>& change);

}  // namespace millpose
