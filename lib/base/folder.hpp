// SPDX-License-Identifier: GPL-3.0-or-later
// A folder that may hold anything: links, pipes, devices, names that lead elsewhere.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/byte_sink.hpp"
#include "base/file_parts.hpp"

namespace millpose {

/// A folder held open. Everything is named relative to it, by names of single components ("job.yaml") or,
/// where it says `below`, several ("programs/krl"); nothing outside is reached: no absolute path, no "..", no
/// symbolic link on the way or at the end. A link is an entry as any other: it can be moved and removed,
/// itself, not what it leads to. Pipes and devices are never opened. All throw InputError with path and
/// reason.
class Folder {
 public:
  enum class Kind : uint8_t { kNothing, kFile, kFolder, kOther };  ///< kOther: link, pipe, device, socket

  /// The folder at a path as the user gave it: links on the way to it are the user's.
  explicit Folder(const std::filesystem::path& path);
  /// The same, made with what is missing on the way.
  static Folder Made(const std::filesystem::path& path);
  ~Folder();
  Folder(Folder&& other) noexcept;
  Folder& operator=(Folder&&) = delete;

  /// As the user gave it, for messages.
  const std::filesystem::path& path() const { return path_; }

  /// Of an entry; kNothing also where a folder on the way is missing.
  Kind KindOf(const std::filesystem::path& below) const;
  /// The entry as the system knows it: changes whenever the entry is renamed or written. Empty without one.
  std::string Identity(const std::string& name) const;
  /// What stands in it, sorted.
  std::vector<std::string> Names() const;

  /// The bytes of a regular file. Throws for anything else and for more than `max_bytes`.
  std::string Read(const std::filesystem::path& below, size_t max_bytes = size_t{4} << 30) const;
  /// Writes to a temporary beside it and renames that; where it fails no temporary stays. What `write` throws
  /// is passed on. Folders on the way are made.
  void Write(const std::filesystem::path& below, const ByteSource& write,
             OnDisk on_disk = OnDisk::kNow) const;
  void Write(const std::filesystem::path& below, std::string_view bytes) const;

  Folder Below(const std::filesystem::path& below) const;
  /// None where one is missing on the way.
  std::optional<Folder> FindBelow(const std::filesystem::path& below) const;
  /// Made where they are missing.
  Folder MakeBelow(const std::filesystem::path& below) const;

  /// Renames an entry, whatever it is, to its own name in `to` or to `as`. A file there is replaced; so is a
  /// folder, with all that it holds.
  void Move(const std::string& name, const Folder& to) const { Move(name, to, name); }
  void Move(const std::string& name, const Folder& to, const std::string& as) const;
  /// The entry, with all that a folder holds; nothing where there is none.
  void RemoveAll(const std::string& name) const;
  /// Waits until names that were made, renamed or removed in it are on the disk.
  void Sync() const;
  /// Waits until all that was written to its file system is on the disk, the bytes of files too: once,
  /// however many files these are.
  void SyncAll() const;
  /// Opens a file for locks, made where it is missing; the caller closes it. Throws for what is no file.
  int OpenForLock(const std::string& name) const;

 private:
  void SyncWith(int (*sync)(int)) const;

  Folder(int file, std::filesystem::path path) : file_(file), path_(std::move(path)) {}

  int file_;
  std::filesystem::path path_;
};

/// Whether a name is one entry of a folder and leads nowhere else: not empty, ".", "..", no '/'.
bool IsPlainName(std::string_view name);

}  // namespace millpose
