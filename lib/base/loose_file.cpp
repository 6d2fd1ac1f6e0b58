// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/loose_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <cerrno>
#include <optional>
#include <system_error>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/writer_name.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

constexpr int kMostLinks = 40;  // as the system's own limit
constexpr const char* kAccessList = "system.posix_acl_access";

std::string Reason() { return std::generic_category().message(errno); }

[[noreturn]] void Refuse(const fs::path& path) {
  throw InputError({path.string()}, "cannot write: " + Reason());
}

// What stands at `path`, links followed; none where there is nothing.
std::optional<struct stat> StatOf(const fs::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0) return info;
  if (errno != ENOENT && errno != ELOOP) Refuse(path);
  return std::nullopt;
}

bool IsLink(const fs::path& path) {
  std::error_code none;
  return fs::is_symlink(fs::symlink_status(path, none));
}

fs::path FolderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

void RemoveLeftBehind(const fs::path& folder) {
  std::error_code ignored;  // what stays is in nobody's way
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored))
    if (IsOfEndedWriter(entry->path().filename().string())) {
      std::error_code stays;
      fs::remove(entry->path(), stays);
    }
}

// A file that is being written: gone with the object unless it was put in its place.
class Unfinished {
 public:
  // `named` is what messages name.
  Unfinished(const fs::path& target, const fs::path& named, mode_t mode)
      : path_(TemporaryBeside(target)), named_(named) {
    file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    if (file_ < 0) Refuse(named_);
  }
  ~Unfinished() {
    ::close(file_);
    if (!done_) ::unlink(path_.c_str());
  }
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  void Write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t count = ::write(file_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) Refuse(named_);
      bytes.remove_prefix(static_cast<size_t>(count));
    }
  }

  // Gives it what `old`, at `target`, is to its users besides its bytes. The mode last: a change of owner
  // takes bits of it away.
  void Resemble(const fs::path& target, const struct stat& old) const {
    struct stat own {};
    if (::fstat(file_, &own) != 0) Refuse(named_);
    const bool same_owner = own.st_uid == old.st_uid && own.st_gid == old.st_gid;
    if (!same_owner && ::fchown(file_, old.st_uid, old.st_gid) != 0)
      throw InputError({named_.string()},
                       fmt::format("belongs to user {}, group {}, which cannot be kept: {}; allowed: "
                                   "to be changed by its owner",
                                   old.st_uid, old.st_gid, Reason()));
    if (::fchmod(file_, old.st_mode & 07777) != 0) Refuse(named_);
    char list[4096];
    const ssize_t size = ::getxattr(target.c_str(), kAccessList, list, sizeof list);
    if (size > 0 && ::fsetxattr(file_, kAccessList, list, static_cast<size_t>(size), 0) != 0) Refuse(named_);
  }

  void PutInPlaceOf(const fs::path& target) {
    if (::fsync(file_) != 0 || ::rename(path_.c_str(), target.c_str()) != 0) Refuse(named_);
    done_ = true;
  }

 private:
  fs::path path_, named_;
  int file_ = -1;
  bool done_ = false;
};

// `target` is no link, unless one that is to be replaced; `path` is what messages name.
void Replace(const fs::path& target, const fs::path& path, std::string_view bytes) {
  const std::optional<struct stat> old = StatOf(target);
  if (old && !S_ISREG(old->st_mode))
    throw InputError({path.string()}, "is not a regular file; allowed: a file, or a name that is free");
  const bool resembles = old && !IsLink(target);
  RemoveLeftBehind(FolderOf(target));
  Unfinished fresh(target, path, resembles ? 0600 : 0644);
  fresh.Write(bytes);
  if (resembles) fresh.Resemble(target, *old);
  fresh.PutInPlaceOf(target);
  SyncFolder(FolderOf(target));
}

fs::path BehindLinks(const fs::path& path) {
  fs::path at = path;
  for (int links = 0; links < kMostLinks && IsLink(at); ++links) {
    const fs::path next = fs::read_symlink(at);
    at = next.is_absolute() ? next : at.parent_path() / next;
  }
  return at;
}

}  // namespace

void WriteLooseFile(const fs::path& path, std::string_view bytes) { Replace(path, path, bytes); }

void EditLooseFile(const fs::path& path, const std::function<std::string(const std::string& text)>& change) {
  const std::string old = ReadFile(path), fresh = change(old);
  if (fresh != old) Replace(BehindLinks(path), path, fresh);
}

}  // namespace millpose
