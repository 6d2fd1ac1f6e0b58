// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace millpose {

/// A lock on a file, which ends with this object or its process however that ends. Open-file-description
/// locks: they hold between threads too, and reach over NFS.
class FileLock {
 public:
  enum class Kind : uint8_t { kShared, kExclusive };
  enum class Outcome : uint8_t { kHeld, kBusy, kNoLocksHere };

  /// Opens the file, which is made where it is missing. Throws InputError, also for what is no regular file.
  explicit FileLock(const std::filesystem::path& path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  /// Takes the lock without waiting. kNoLocksHere: the file system has none.
  Outcome Take(Kind kind);

 private:
  int file_;
};

}  // namespace millpose
