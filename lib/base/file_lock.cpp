// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/file_lock.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "base/folder.hpp"

namespace millpose {

FileLock::FileLock(const std::filesystem::path& path)
    : file_(Folder(path.parent_path()).OpenForLock(path.filename().string())) {}

FileLock::~FileLock() { ::close(file_); }

FileLock::Outcome FileLock::Take(Kind kind) {
  struct flock lock {};
  lock.l_type = kind == Kind::kShared ? F_RDLCK : F_WRLCK;
  lock.l_whence = SEEK_SET;  // from the start, and for length 0 to the end
  int result = 0;
  do result = ::fcntl(file_, F_OFD_SETLK, &lock);
  while (result != 0 && errno == EINTR);
  if (result == 0) return Outcome::kHeld;
  return errno == EAGAIN || errno == EACCES ? Outcome::kBusy : Outcome::kNoLocksHere;
}

}  // namespace millpose
