// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/file_root.hpp"

#include "base/error.hpp"
#include "base/file.hpp"

namespace millpose {
namespace fs = std::filesystem;

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
  if (!folder_ || !fs::is_directory(folder)) return;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_symlink())
      throw InputError({entry.path().string()},
                       "is a symbolic link; allowed in an output folder within --root: none");
}

std::string FileRoot::Read(const fs::path& path, size_t max_bytes) const {
  Check(path);
  return ReadFile(path, max_bytes);
}

}  // namespace millpose
