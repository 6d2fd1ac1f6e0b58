// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/folder.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/file_parts.hpp"
#include "base/writer_name.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

constexpr int kWayFlags = O_PATH | O_DIRECTORY | O_CLOEXEC;

[[noreturn]] void FailAt(const fs::path& path, std::string_view what, int error) {
  throw InputError({path.string()}, fmt::format("{}: {}", what, std::generic_category().message(error)));
}

bool StandsNot(int error) { return error == ENOENT; }

void CheckPlain(const std::string& name, const Folder& folder) {
  if (!IsPlainName(name))
    throw InputError({folder.path().string()}, fmt::format("{:?} names nothing in this folder", name));
}

// What stands there in place of a file or a folder.
[[noreturn]] void RefuseKind(const fs::path& path, mode_t mode, const char* expected) {
  throw InputError({path.string()},
                   S_ISLNK(mode) ? fmt::format("is a symbolic link, which millpose follows nowhere in an "
                                               "output folder; allowed: {}",
                                               expected)
                                 : fmt::format("is not {}", expected));
}

// The entry itself; none where it is missing.
std::optional<struct stat> Look(int folder, const std::string& name, const fs::path& path) {
  struct stat info {};
  if (::fstatat(folder, name.c_str(), &info, AT_SYMLINK_NOFOLLOW) == 0) return info;
  if (!StandsNot(errno)) FailAt(path, "cannot look for it", errno);
  return std::nullopt;
}

std::string ReadOpen(int file, const fs::path& path, size_t max_bytes) {
  struct stat info {};
  if (::fstat(file, &info) != 0) FailAt(path, "cannot read", errno);
  if (!S_ISREG(info.st_mode)) RefuseKind(path, info.st_mode, "a regular file");
  const auto size = static_cast<size_t>(info.st_size);
  if (size > max_bytes)
    throw InputError({path.string()}, fmt::format("{} bytes, at most {} are allowed", size, max_bytes));
  std::string bytes(size, '\0');
  size_t done = 0;
  while (done < size) {
    const ssize_t count = ::read(file, bytes.data() + done, size - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) FailAt(path, "cannot read", errno);
    if (count == 0) break;
    done += static_cast<size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

}  // namespace

bool IsPlainName(std::string_view name) {
  return !name.empty() && name != "." && name != ".." && name.find('/') == std::string_view::npos &&
         name.find('\0') == std::string_view::npos;
}

Folder::Folder(const fs::path& path)
    : file_(::open(path.empty() ? "." : path.c_str(), kWayFlags)), path_(path) {
  if (file_ < 0) FailAt(path, "cannot open", errno);
}

Folder Folder::Made(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) FailAt(path, "cannot make this folder", error.value());
  return Folder(path);
}

Folder::~Folder() {
  if (file_ >= 0) ::close(file_);
}

Folder::Folder(Folder&& other) noexcept : file_(other.file_), path_(std::move(other.path_)) {
  other.file_ = -1;
}

Folder::Kind Folder::KindOf(const fs::path& below) const {
  const std::optional<Folder> folder = FindBelow(below.parent_path());
  if (!folder) return Kind::kNothing;
  const std::string name = below.filename().string();
  CheckPlain(name, *folder);
  const std::optional<struct stat> info = Look(folder->file_, name, path_ / below);
  if (!info) return Kind::kNothing;
  if (S_ISREG(info->st_mode)) return Kind::kFile;
  return S_ISDIR(info->st_mode) ? Kind::kFolder : Kind::kOther;
}

std::string Folder::Identity(const std::string& name) const {
  const std::optional<struct stat> info = Look(file_, name, path_ / name);
  if (!info) return "";
  return fmt::format("{} {} {} {}.{}", info->st_dev, info->st_ino, info->st_size, info->st_ctim.tv_sec,
                     info->st_ctim.tv_nsec);
}

std::vector<std::string> Folder::Names() const {
  const int file = ::openat(file_, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  DIR* const entries = file < 0 ? nullptr : ::fdopendir(file);
  if (!entries) {
    const int error = errno;
    if (file >= 0) ::close(file);
    FailAt(path_, "cannot read this folder", error);
  }
  std::vector<std::string> names;
  errno = 0;
  while (const dirent* entry = ::readdir(entries))
    if (IsPlainName(entry->d_name)) names.emplace_back(entry->d_name);
  const int error = errno;
  ::closedir(entries);
  if (error != 0) FailAt(path_, "cannot read this folder", error);
  std::ranges::sort(names);
  return names;
}

std::string Folder::Read(const fs::path& below, size_t max_bytes) const {
  const Folder folder = Below(below.parent_path());
  const fs::path path = path_ / below;
  const std::string name = below.filename().string();
  CheckPlain(name, folder);
  if (const auto info = Look(folder.file_, name, path); info && !S_ISREG(info->st_mode))
    RefuseKind(path, info->st_mode, "a regular file");
  const int file =
      ::openat(folder.file_, name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (file < 0) FailAt(path, "cannot open", errno);
  try {
    std::string bytes = ReadOpen(file, path, max_bytes);
    ::close(file);
    return bytes;
  } catch (...) {
    ::close(file);
    throw;
  }
}

void Folder::Write(const fs::path& below, std::string_view bytes) const {
  Write(below, [&](const ByteSink& sink) { sink(bytes); });
}

void Folder::Write(const fs::path& below, const ByteSource& write, OnDisk on_disk) const {
  const Folder folder = MakeBelow(below.parent_path());
  const std::string name = below.filename().string();
  CheckPlain(name, folder);
  WriteFileAt(folder.file_, name, path_ / below, write, on_disk);
}

Folder Folder::Below(const fs::path& below) const {
  std::optional<Folder> folder = FindBelow(below);
  if (!folder) FailAt(path_ / below, "cannot open", ENOENT);
  return std::move(*folder);
}

std::optional<Folder> Folder::FindBelow(const fs::path& below) const {
  Folder at(::openat(file_, ".", kWayFlags), path_);
  if (at.file_ < 0) FailAt(path_, "cannot open", errno);
  for (const fs::path& part : below) {
    const std::string name = part.string();
    CheckPlain(name, at);
    const fs::path path = at.path_ / name;
    const int file = ::openat(at.file_, name.c_str(), kWayFlags | O_NOFOLLOW);
    if (file < 0) {
      const int error = errno;
      if (StandsNot(error)) return std::nullopt;
      if (const auto info = Look(at.file_, name, path); info && !S_ISDIR(info->st_mode))
        RefuseKind(path, info->st_mode, "a folder");
      FailAt(path, "cannot open", error);
    }
    const int before = std::exchange(at.file_, file);
    ::close(before);
    at.path_ = path;
  }
  return at;
}

Folder Folder::MakeBelow(const fs::path& below) const {
  fs::path made;
  for (const fs::path& part : below) {
    const Folder at = Below(made);
    CheckPlain(part.string(), at);
    if (::mkdirat(at.file_, part.c_str(), 0777) != 0 && errno != EEXIST)
      FailAt(at.path_ / part, "cannot make this folder", errno);
    made /= part;
  }
  return Below(made);
}

void Folder::Move(const std::string& name, const Folder& to, const std::string& as) const {
  CheckPlain(name, *this);
  CheckPlain(as, to);
  const auto rename = [&] { return ::renameat(file_, name.c_str(), to.file_, as.c_str()) == 0; };
  if (rename()) return;
  int error = errno;
  if (error == ENOTEMPTY || error == EEXIST || error == EISDIR || error == ENOTDIR) {
    to.RemoveAll(as);
    if (rename()) return;
    error = errno;
  }
  FailAt(path_ / name, fmt::format("cannot rename to {}", (to.path_ / as).string()), error);
}

void Folder::RemoveAll(const std::string& name) const {
  CheckPlain(name, *this);
  const fs::path path = path_ / name;
  const std::optional<struct stat> info = Look(file_, name, path);
  if (!info) return;
  const bool is_folder = S_ISDIR(info->st_mode);
  if (is_folder) {
    const Folder folder = Below(name);
    for (const std::string& entry : folder.Names()) folder.RemoveAll(entry);
  }
  if (::unlinkat(file_, name.c_str(), is_folder ? AT_REMOVEDIR : 0) != 0 && errno != ENOENT)
    FailAt(path, "cannot remove", errno);
}

void Folder::SyncWith(int (*sync)(int)) const {
  const int file = ::openat(file_, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) FailAt(path_, "cannot open", errno);
  const int error = sync(file) == 0 ? 0 : errno;
  ::close(file);
  // Some file systems know no sync of folders and say so.
  if (error != 0 && error != EINVAL && error != ENOTSUP) FailAt(path_, "cannot write", error);
}

void Folder::Sync() const { SyncWith(::fsync); }

void Folder::SyncAll() const { SyncWith(::syncfs); }

int Folder::OpenForLock(const std::string& name) const {
  CheckPlain(name, *this);
  const fs::path path = path_ / name;
  if (const auto info = Look(file_, name, path); info && !S_ISREG(info->st_mode))
    RefuseKind(path, info->st_mode, "a regular file");
  const int file =
      ::openat(file_, name.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, 0666);
  if (file < 0) FailAt(path, "cannot write", errno);
  return file;
}

}  // namespace millpose
