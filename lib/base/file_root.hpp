// SPDX-License-Identifier: GPL-3.0-or-later
// Where the files may lie that other people's jobs name.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace millpose {

/// All files, or those of one folder. A file is taken for where it lies when every symbolic link on its way
/// is followed; the folder must not be changed meanwhile by whoever is not trusted.
class FileRoot {
 public:
  /// No bound.
  FileRoot() = default;
  /// Throws InputError when there is no such folder.
  explicit FileRoot(const std::filesystem::path& folder);
  /// The bound of an option: none where it is not given.
  static FileRoot Of(const std::optional<std::filesystem::path>& folder);

  /// Throws InputError for what lies outside, whether it exists or not.
  void Check(const std::filesystem::path& path) const;
  /// As Check(), for an output folder: nothing in it may be a symbolic link either.
  void CheckFolder(const std::filesystem::path& folder) const;
  /// ReadFile() of what lies inside; `max_bytes` as there.
  std::string Read(const std::filesystem::path& path, size_t max_bytes = size_t{4} << 30) const;

  const std::optional<std::filesystem::path>& folder() const { return folder_; }

 private:
  std::optional<std::filesystem::path> folder_;  ///< absolute, without links
};

}  // namespace millpose
