// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "base/error.hpp"
#include "base/file_parts.hpp"
#include "base/writer_name.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void Fail(const fs::path& path, std::string_view what, std::error_code cause) {
  throw InputError({path.string()}, fmt::format("{}: {}", what, cause.message()));
}

[[noreturn]] void Fail(const fs::path& path, std::string_view what) {
  Fail(path, what, {errno, std::generic_category()});
}

// Closes the descriptor when the scope ends.
struct Descriptor {
  int value;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};

constexpr const char* kNotWritten = "cannot write";

// `path` is what messages name.
void WriteAll(int file, std::string_view bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) Fail(path, kNotWritten);
    bytes.remove_prefix(static_cast<size_t>(count));
  }
}

void WriteTemporary(int folder, const std::string& temporary, const ByteSource& write, const fs::path& path,
                    OnDisk on_disk) {
  const Descriptor file{
      ::openat(folder, temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644)};
  if (file.value < 0) Fail(path, kNotWritten);
  write([&](std::string_view bytes) { WriteAll(file.value, bytes, path); });
  if (on_disk == OnDisk::kNow && ::fsync(file.value) != 0) Fail(path, kNotWritten);
}

void CheckIsFile(const fs::path& path, const struct stat& info) {
  if (S_ISREG(info.st_mode)) return;
  const std::string_view kind = S_ISDIR(info.st_mode)    ? "a folder"
                                : S_ISFIFO(info.st_mode) ? "a FIFO"
                                : S_ISSOCK(info.st_mode) ? "a socket"
                                                         : "a device";
  throw InputError({path.string()}, fmt::format("not a regular file but {}", kind));
}

}  // namespace

std::string ReadFile(const fs::path& path, size_t max_bytes) {
  struct stat info {};
  // Looked at before it is opened: opening a FIFO waits for its writer, opening a device may do anything.
  if (::stat(path.c_str(), &info) != 0) Fail(path, "cannot open");
  CheckIsFile(path, info);
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)};
  if (file.value < 0) Fail(path, "cannot open");
  if (::fstat(file.value, &info) != 0) Fail(path, "cannot read");
  CheckIsFile(path, info);
  const auto size = static_cast<size_t>(info.st_size);
  if (size > max_bytes)
    throw InputError({path.string()}, fmt::format("{} bytes, at most {} are allowed", size, max_bytes));
  std::string bytes(size, '\0');
  size_t done = 0;
  while (done < size) {
    const ssize_t count = ::read(file.value, bytes.data() + done, size - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) Fail(path, "cannot read");
    if (count == 0) break;
    done += static_cast<size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

void WriteFileAtomically(const fs::path& path, std::string_view bytes) {
  WriteFileAtomically(path, [&](const ByteSink& sink) { sink(bytes); });
}

void WriteFileAtomically(const fs::path& path, const ByteSource& write) {
  const fs::path parent = path.has_parent_path() ? path.parent_path() : ".";
  const Descriptor folder{::open(parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC)};
  if (folder.value < 0) Fail(path, kNotWritten);
  WriteFileAt(folder.value, path.filename().string(), path, write);
}

void WriteFileAt(int folder, const std::string& name, const fs::path& path, const ByteSource& write,
                 OnDisk on_disk) {
  const std::string temporary = TemporaryName(name);
  try {
    WriteTemporary(folder, temporary, write, path, on_disk);
    if (::renameat(folder, temporary.c_str(), folder, name.c_str()) != 0) Fail(path, kNotWritten);
  } catch (...) {
    ::unlinkat(folder, temporary.c_str(), 0);
    throw;
  }
}

bool Exists(const fs::path& path) {
  std::error_code error;
  const bool exists = fs::exists(path, error);
  if (error) Fail(path, "cannot look for it", error);
  return exists;
}

void MakeFolders(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) Fail(folder, "cannot make this folder", error);
}

void Rename(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) Fail(from, fmt::format("cannot rename to {}", to.string()), error);
}

void RemoveAll(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (error) Fail(path, "cannot remove", error);
}

std::vector<fs::path> EntriesOf(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    entries.push_back(entry->path());
  if (error && error != std::errc::no_such_file_or_directory) Fail(folder, "cannot read this folder", error);
  std::ranges::sort(entries);
  return entries;
}

void SyncFolder(const fs::path& folder) {
  const Descriptor file{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (file.value < 0) Fail(folder, "cannot open");
  // Some file systems know no sync of folders and say so.
  if (::fsync(file.value) != 0 && errno != EINVAL && errno != ENOTSUP) Fail(folder, "cannot write");
}

}  // namespace millpose
