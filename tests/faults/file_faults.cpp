// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded with LD_PRELOAD: counts what a program does to files below MILLPOSE_FAULT_ROOT, and at operation
// number MILLPOSE_FAULT_AT (from 1) does what MILLPOSE_FAULT says: `kill` ends the process as SIGKILL would
// at that moment; ENOSPC, EACCES, EROFS or EIO lets that one operation fail, and with MILLPOSE_FAULT_STAYS
// all after it too; with MILLPOSE_FAULT_OWN the program's children know nothing of it. At its end the count
// goes to the file MILLPOSE_FAULT_COUNT. With MILLPOSE_FAULT_NO_LOCKS there are no locks, as on some network
// file systems.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

template <class Function>
Function* Real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

std::string Environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

struct Plan {
  std::string root = Environment("MILLPOSE_FAULT_ROOT"), what = Environment("MILLPOSE_FAULT");
  long at = std::atol(Environment("MILLPOSE_FAULT_AT").c_str());
  bool stays = !Environment("MILLPOSE_FAULT_STAYS").empty();
  std::atomic<long> count = 0;

  Plan() {
    if (!Environment("MILLPOSE_FAULT_OWN").empty()) ::unsetenv("MILLPOSE_FAULT_ROOT");  // for its children
  }
  ~Plan() {
    const std::string file = Environment("MILLPOSE_FAULT_COUNT");
    if (file.empty()) return;
    if (std::FILE* out = std::fopen(file.c_str(), "w")) {
      std::fprintf(out, "%ld\n", count.load());
      std::fclose(out);
    }
  }
};

Plan& ThePlan() {
  static Plan plan;
  return plan;
}

int ErrorNumber(const std::string& what) {
  if (what == "ENOSPC") return ENOSPC;
  if (what == "EACCES") return EACCES;
  return what == "EROFS" ? EROFS : EIO;
}

// Counts one operation; true where it has to fail, with errno set.
bool Fails(const std::string& path) {
  Plan& plan = ThePlan();
  if (plan.root.empty() || path.compare(0, plan.root.size(), plan.root) != 0) return false;
  const long number = ++plan.count;
  if (plan.at == 0 || number < plan.at || (number > plan.at && !plan.stays)) return false;
  if (plan.what == "kill") ::raise(SIGKILL);
  errno = ErrorNumber(plan.what);
  return true;
}

std::string PathOf(int file) {
  char path[PATH_MAX] = "";
  const std::string link = "/proc/self/fd/" + std::to_string(file);
  const ssize_t size = ::readlink(link.c_str(), path, sizeof path);
  return size > 0 ? std::string(path, static_cast<size_t>(size)) : "";
}

std::string PathAt(int folder, const char* name) {
  return name[0] == '/' || folder == AT_FDCWD ? std::string(name) : PathOf(folder) + '/' + name;
}

int OpenAs(const char* function, const char* path, int flags, mode_t mode) {
  if ((flags & (O_CREAT | O_WRONLY | O_RDWR)) != 0 && Fails(path)) return -1;
  return Real<int(const char*, int, ...)>(function)(path, flags, mode);
}

int OpenAtAs(const char* function, int folder, const char* name, int flags, mode_t mode) {
  if ((flags & (O_CREAT | O_WRONLY | O_RDWR)) != 0 && Fails(PathAt(folder, name))) return -1;
  return Real<int(int, const char*, int, ...)>(function)(folder, name, flags, mode);
}

int FcntlAs(const char* function, int file, int command, void* argument) {
  static const bool no_locks = !Environment("MILLPOSE_FAULT_NO_LOCKS").empty();
  if (command == F_OFD_SETLK && no_locks) {
    errno = ENOLCK;
    return -1;
  }
  return Real<int(int, int, ...)>(function)(file, command, argument);
}

mode_t ModeOf(int flags, va_list arguments) {
  return (flags & O_CREAT) != 0 ? static_cast<mode_t>(va_arg(arguments, int)) : 0;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = ModeOf(flags, arguments);
  va_end(arguments);
  return OpenAs("open", path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = ModeOf(flags, arguments);
  va_end(arguments);
  return OpenAs("open64", path, flags, mode);
}

int fcntl(int file, int command, ...) {
  va_list arguments;
  va_start(arguments, command);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  return FcntlAs("fcntl", file, command, argument);
}

int fcntl64(int file, int command, ...) {
  va_list arguments;
  va_start(arguments, command);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  return FcntlAs("fcntl64", file, command, argument);
}

ssize_t write(int file, const void* bytes, size_t size) {
  if (file > 2 && Fails(PathOf(file))) {
    // A full disk takes a part first.
    if (errno == ENOSPC && size > 1) Real<ssize_t(int, const void*, size_t)>("write")(file, bytes, size / 2);
    errno = ErrorNumber(ThePlan().what);
    return -1;
  }
  return Real<ssize_t(int, const void*, size_t)>("write")(file, bytes, size);
}

int syncfs(int file) { return Fails(PathOf(file)) ? -1 : Real<int(int)>("syncfs")(file); }
int fsync(int file) { return Fails(PathOf(file)) ? -1 : Real<int(int)>("fsync")(file); }

int openat(int folder, const char* name, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = ModeOf(flags, arguments);
  va_end(arguments);
  return OpenAtAs("openat", folder, name, flags, mode);
}

int openat64(int folder, const char* name, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = ModeOf(flags, arguments);
  va_end(arguments);
  return OpenAtAs("openat64", folder, name, flags, mode);
}

int renameat(int from_folder, const char* from, int to_folder, const char* to) {
  return Fails(PathAt(from_folder, from))
             ? -1
             : Real<int(int, const char*, int, const char*)>("renameat")(from_folder, from, to_folder, to);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  return Fails(PathAt(from_folder, from)) ? -1
                                          : Real<int(int, const char*, int, const char*, unsigned)>(
                                                "renameat2")(from_folder, from, to_folder, to, flags);
}

int mkdirat(int folder, const char* name, mode_t mode) {
  return Fails(PathAt(folder, name)) ? -1
                                     : Real<int(int, const char*, mode_t)>("mkdirat")(folder, name, mode);
}

int rename(const char* from, const char* to) {
  return Fails(from) ? -1 : Real<int(const char*, const char*)>("rename")(from, to);
}

int mkdir(const char* path, mode_t mode) {
  return Fails(path) ? -1 : Real<int(const char*, mode_t)>("mkdir")(path, mode);
}

int unlink(const char* path) { return Fails(path) ? -1 : Real<int(const char*)>("unlink")(path); }

int rmdir(const char* path) { return Fails(path) ? -1 : Real<int(const char*)>("rmdir")(path); }

int remove(const char* path) { return Fails(path) ? -1 : Real<int(const char*)>("remove")(path); }

int unlinkat(int folder, const char* name, int flags) {
  return Fails(PathAt(folder, name)) ? -1 : Real<int(int, const char*, int)>("unlinkat")(folder, name, flags);
}

}  // extern "C"
