// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/process.hpp"

#include <fcntl.h>
#include <link.h>
#include <poll.h>
#include <spawn.h>
#include <sys/auxv.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <filesystem>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"

extern char** environ;

namespace millpose {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kPollMs = 100;
constexpr std::chrono::seconds kGrace{5};

// One direction of output; both ends are closed on every way out.
struct Pipe {
  int ends[2] = {-1, -1};
  Pipe() {
    if (::pipe2(ends, O_CLOEXEC) != 0)
      throw InputError(SourceLocation{}, fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  }
  ~Pipe() {
    Close(0);
    Close(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void Close(int end) {
    if (ends[end] >= 0) ::close(ends[end]);
    ends[end] = -1;
  }
};

// The child's stdin: bytes in memory, so that nobody waits for it to read them.
class Input {
 public:
  explicit Input(std::string_view bytes) : file_(::memfd_create("input", MFD_CLOEXEC)) {
    while (file_ >= 0 && !bytes.empty()) {
      const ssize_t count = ::write(file_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      bytes.remove_prefix(static_cast<size_t>(count));
    }
    if (file_ < 0 || !bytes.empty() || ::lseek(file_, 0, SEEK_SET) != 0) {
      const std::string why = std::strerror(errno);
      if (file_ >= 0) ::close(file_);
      throw InputError(SourceLocation{}, fmt::format("cannot keep a process's input in memory: {}", why));
    }
  }
  ~Input() { ::close(file_); }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  int file() const { return file_; }

 private:
  int file_;
};

pid_t Spawn(const std::vector<std::string>& arguments, const Input& input, const Pipe& output,
            const Pipe& errors) {
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input.file(), 0);
  posix_spawn_file_actions_adddup2(&actions, output.ends[1], 1);
  posix_spawn_file_actions_adddup2(&actions, errors.ends[1], 2);
  // The child gets no blocked signals, none that is ignored here, and a process group of its own: Ctrl-C
  // reaches the parent alone, which stops its children in order.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  sigset_t ignored;
  sigemptyset(&ignored);
  sigaddset(&ignored, SIGPIPE);
  posix_spawnattr_setsigdefault(&attributes, &ignored);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw InputError(SourceLocation{arguments[0]},
                     fmt::format("cannot be started: {}", std::strerror(error)));
  return child;
}

// Appends what can be read now; false at the end of the stream.
bool Drain(Pipe* pipe, std::string* text) {
  char buffer[65536];
  const ssize_t count = ::read(pipe->ends[0], buffer, sizeof buffer);
  if (count < 0) return errno == EINTR || errno == EAGAIN;
  if (count == 0) {
    pipe->Close(0);
    return false;
  }
  text->append(buffer, static_cast<size_t>(count));
  return true;
}

// The content of the note NT_GNU_BUILD_ID among the notes at an address; empty when there is none.
std::string BuildId(const char* at, size_t size) {
  const auto padded = [](size_t length) { return (length + 3) & ~size_t{3}; };
  for (const char* const end = at + size; at + sizeof(ElfW(Nhdr)) <= end;) {
    ElfW(Nhdr) note;
    std::memcpy(&note, at, sizeof note);
    const char* name = at + sizeof note;
    const char* content = name + padded(note.n_namesz);
    if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 && std::memcmp(name, "GNU", 4) == 0)
      return {content, note.n_descsz};
    at = content + padded(note.n_descsz);
  }
  return {};
}

// Hands on the lines that are complete; `from` is where the next one begins.
void TellLines(const std::string& text, const std::function<void(std::string_view)>& hear, size_t& from) {
  for (size_t end; (end = text.find('\n', from)) != std::string::npos; from = end + 1)
    if (hear) hear(std::string_view(text).substr(from, end - from));
}

// Passes a stop request on to a child: first asks it to end, then ends it and its own children.
class StopOfChild {
 public:
  StopOfChild(pid_t child, const std::stop_token& stop) : child_(child), stop_(stop) {}

  void Pass() {
    if (!stop_.stop_requested()) return;
    if (!asked_) {
      ::kill(child_, SIGTERM);
      asked_ = true;
      asked_at_ = Clock::now();
    } else if (!killed_ && Clock::now() - asked_at_ > kGrace) {
      ::kill(-child_, SIGKILL);
      killed_ = true;
    }
  }

 private:
  pid_t child_;
  const std::stop_token& stop_;
  bool asked_ = false, killed_ = false;
  Clock::time_point asked_at_;
};

// Reads both streams until the child closed them.
void Follow(Pipe* output, Pipe* errors, StopOfChild* stop, const std::function<void(std::string_view)>& hear,
            ProcessResult* result) {
  size_t heard = 0;
  while (output->ends[0] >= 0 || errors->ends[0] >= 0) {
    pollfd streams[2] = {{output->ends[0], POLLIN, 0}, {errors->ends[0], POLLIN, 0}};
    ::poll(streams, 2, kPollMs);
    if (streams[0].revents != 0) Drain(output, &result->output);
    if (streams[1].revents != 0) {
      Drain(errors, &result->errors);
      TellLines(result->errors, hear, heard);
    }
    stop->Pass();
  }
}

// Waits for the end of a child that may have closed its streams before.
int WaitFor(pid_t child, StopOfChild* stop, rusage* usage) {
  int status = 0;
  constexpr timespec kPause{0, 1'000'000};
  for (pid_t ended = 0; ended != child;) {
    ended = ::wait4(child, &status, WNOHANG, usage);
    if (ended == child || (ended < 0 && errno != EINTR)) break;
    stop->Pass();
    ::nanosleep(&kPause, nullptr);
  }
  return status;
}

}  // namespace

ProcessResult RunProcess(const std::vector<std::string>& arguments, std::stop_token stop,
                         std::string_view input, const std::function<void(std::string_view)>& told) {
  const Input bytes(input);
  Pipe output, errors;
  const Clock::time_point start = Clock::now();
  const pid_t child = Spawn(arguments, bytes, output, errors);
  output.Close(1);
  errors.Close(1);
  ProcessResult result;
  StopOfChild stopping(child, stop);
  Follow(&output, &errors, &stopping, told, &result);
  rusage usage{};
  const int status = WaitFor(child, &stopping, &usage);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.peak_memory_MB = static_cast<double>(usage.ru_maxrss) / 1024;
  result.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  if (stop.stop_requested()) throw Interrupted();
  return result;
}

void EndWithParent() {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  pollfd output{1, POLLOUT, 0};
  if (::poll(&output, 1, 0) > 0 && (output.revents & POLLERR) != 0) ::_exit(1);
}

double MachineMemory() {
  const double pages = static_cast<double>(::sysconf(_SC_PHYS_PAGES));
  double bytes = pages * static_cast<double>(::sysconf(_SC_PAGESIZE));
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    bytes = std::min(bytes, static_cast<double>(limit.rlim_cur));
  return bytes;
}

// Memory rather than the file: there may be no /proc.
std::string ProgramId() {
  std::string id;
  ::dl_iterate_phdr(
      [](dl_phdr_info* object, size_t /*size*/, void* result) {
        for (int i = 0; i < object->dlpi_phnum; ++i) {
          const ElfW(Phdr)& part = object->dlpi_phdr[i];
          if (part.p_type != PT_NOTE) continue;
          // NOLINTNEXTLINE(performance-no-int-to-ptr): the loader tells addresses as numbers
          const auto* notes = reinterpret_cast<const char*>(object->dlpi_addr + part.p_vaddr);
          *static_cast<std::string*>(result) += BuildId(notes, part.p_memsz);
        }
        return 1;  // the first object is the program itself
      },
      &id);
  return Hash(id.empty() ? ReadFile("/proc/self/exe") : id);
}

std::string OwnProgram() {
  std::error_code none;
  const std::filesystem::path link = std::filesystem::read_symlink("/proc/self/exe", none);
  if (!none) return link.string();
  // Without /proc: as the kernel was told to start it.
  // NOLINTNEXTLINE(performance-no-int-to-ptr): the kernel tells addresses as numbers
  const auto* told = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
  return std::filesystem::absolute(told ? told : "").string();
}

}  // namespace millpose
