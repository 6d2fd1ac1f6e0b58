// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace millpose {

/// Whether `folder` was written by millpose.
bool IsOutputFolder(const std::filesystem::path& folder);

/// The folder that a plan writes into. It is marked as millpose's own, so that no other folder is ever
/// overwritten.
class OutputFolder {
 public:
  /// Makes the folder, or takes it over when it carries the mark. Throws InputError when it exists, is not
  /// empty and is not millpose's.
  explicit OutputFolder(std::filesystem::path folder);

  const std::filesystem::path& path() const { return folder_; }

  /// Writes one file (name relative to the folder) atomically.
  void Write(const std::string& name, std::string_view bytes) const;

  /// Removes results of an earlier plan: they must not stand beside new ones that differ. Checkpoints
  /// stay, but for what a killed run left half-written; so call it when nothing else writes here any more.
  void RemoveResults() const;

  /// Puts all files of programs in place at once, by renaming a folder that was written completely.
  void WritePrograms(const std::map<std::string, std::string>& files) const;

  /// A checkpoint's bytes, or empty when there is none.
  std::optional<std::string> ReadCheckpoint(const std::string& key) const;
  void WriteCheckpoint(const std::string& key, std::string_view bytes) const;
  void RemoveCheckpoints() const;

 private:
  std::filesystem::path folder_;
};

}  // namespace millpose
