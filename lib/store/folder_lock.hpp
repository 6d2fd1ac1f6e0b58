// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/file_lock.hpp"

namespace millpose {

/// The right to write into an output folder: either to add checkpoints, beside others that do, or alone to
/// write results. A file `.owner.HOST.PROCESS.NUMBER` says who has it; where the file system has no locks
/// that file is all there is, and `warning` says so.
class FolderLock {
 public:
  /// Throws InputError naming who has the folder (host, process, since when) where it cannot be had.
  FolderLock(const std::filesystem::path& folder, FileLock::Kind kind);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  const std::string& warning() const { return warning_; }

 private:
  std::filesystem::path owner_file_;
  FileLock lock_;
  std::string warning_;
};

/// Whether a file of this name belongs to the lock and not to what the folder holds.
bool IsOfLock(const std::string& name);

}  // namespace millpose
