// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstring>

#include "base/error.hpp"

namespace millpose {
namespace {

[[noreturn]] void Fail(const std::filesystem::path& path, std::string_view what) {
  throw InputError({path.string()}, fmt::format("{}: {}", what, std::strerror(errno)));
}

// Closes the descriptor when the scope ends.
struct Descriptor {
  int value;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};

}  // namespace

std::string ReadFile(const std::filesystem::path& path, size_t max_bytes) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.value < 0) Fail(path, "cannot open");
  struct stat info {};
  if (::fstat(file.value, &info) != 0) Fail(path, "cannot read");
  if (!S_ISREG(info.st_mode)) throw InputError({path.string()}, "not a regular file");
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

void WriteFileAtomically(const std::filesystem::path& path, std::string_view bytes) {
  // Unique also among machines that share the folder.
  char host[HOST_NAME_MAX + 1] = "";
  ::gethostname(host, sizeof host - 1);
  const std::string temporary = fmt::format("{}.{}.{}.tmp", path.string(), host, ::getpid());
  {
    const Descriptor file{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)};
    if (file.value < 0) Fail(path, "cannot write");
    size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t count = ::write(file.value, bytes.data() + done, bytes.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) {
        ::unlink(temporary.c_str());
        Fail(path, "cannot write");
      }
      done += static_cast<size_t>(count);
    }
    if (::fsync(file.value) != 0) Fail(path, "cannot write");
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    ::unlink(temporary.c_str());
    Fail(path, "cannot write");
  }
}

}  // namespace millpose
