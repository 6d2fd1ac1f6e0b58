// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/file_root.hpp"

#include "base/error.hpp"
#include "base/file.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

// What another run moves or removes meanwhile is no link.
void RefuseLinks(const fs::path& folder) {
  std::error_code gone;
  if (!fs::is_directory(folder, gone)) return;
  for (const fs::path& entry : EntriesOf(folder)) {
    const fs::file_status status = fs::symlink_status(entry, gone);
    if (fs::is_symlink(status))
      throw InputError({entry.string()},
                       "is a symbolic link; allowed in an output folder within --root: none");
    if (fs::is_directory(status)) RefuseLinks(entry);
  }
}

}  // namespace

FileRoot::FileRoot(const fs::path& folder) {
  std::error_code error;
  folder_ = fs::canonical(folder, error);
  if (error || !fs::is_directory(*folder_))
    throw InputError({folder.string()}, "no such folder; allowed: the folder that all files must lie in");
}

FileRoot FileRoot::Of(const std::optional<fs::path>& folder) {
  return folder ? FileRoot(*folder) : FileRoot();
}

void FileRoot::Check(const fs::path& path) const {
  if (!folder_) return;
  std::error_code error;
  // What does not exist yet is followed as far as it does.
  const fs::path place = fs::weakly_canonical(fs::absolute(path), error);
  const auto [end, at] = std::mismatch(folder_->begin(), folder_->end(), place.begin(), place.end());
  if (error || end != folder_->end())
    throw InputError({path.string()},
                     fmt::format("lies outside of {}; allowed: files within it", folder_->string()));
}

void FileRoot::CheckFolder(const fs::path& folder) const {
  Check(folder);
  if (folder_) RefuseLinks(folder);
}

std::string FileRoot::Read(const fs::path& path, size_t max_bytes) const {
  Check(path);
  return ReadFile(path, max_bytes);
}

}  // namespace millpose
