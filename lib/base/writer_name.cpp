// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/writer_name.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <climits>
#include <csignal>
#include <fstream>
#include <optional>

namespace millpose {
namespace {

constexpr std::string_view kTemporaryEnding = ".tmp";
constexpr size_t kLongestShown = 60;  // bytes of a name; a file name has 255

struct Writer {
  std::string host;
  int process = 0;
  uint64_t start = 0;
};

// 0 where the system does not tell.
uint64_t StartOf(int process) {
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  std::string text;
  std::getline(file, text);
  // The second field, a name in brackets, may hold blanks; the start is the 22nd.
  size_t at = text.rfind(')');
  for (int field = 2; at != std::string::npos && field < 22; ++field) at = text.find(' ', at + 1);
  if (at == std::string::npos) return 0;
  uint64_t start = 0;
  std::from_chars(text.data() + at + 1, text.data() + text.size(), start);
  return start;
}

// As one component of a name.
std::string HostPart() {
  std::string host = HostName();
  std::ranges::replace(host, '.', '_');
  return host;
}

// Takes ".NUMBER" off the end.
template <class Number>
bool TakeNumber(std::string_view* text, Number* number) {
  const size_t dot = text->rfind('.');
  if (dot == std::string_view::npos || dot + 1 == text->size()) return false;
  const char* end = text->data() + text->size();
  const auto [stopped, error] = std::from_chars(text->data() + dot + 1, end, *number);
  text->remove_suffix(text->size() - dot);
  return error == std::errc() && stopped == end;
}

// Read from behind: the name may hold dots.
std::optional<Writer> WriterOf(std::string_view name) {
  if (!name.starts_with('.') || !name.ends_with(kTemporaryEnding)) return std::nullopt;
  name.remove_suffix(kTemporaryEnding.size());
  Writer writer;
  unsigned number = 0;
  if (!TakeNumber(&name, &number) || !TakeNumber(&name, &writer.start) ||
      !TakeNumber(&name, &writer.process) || writer.process <= 0)
    return std::nullopt;
  const size_t dot = name.rfind('.');
  if (dot == std::string_view::npos || dot == 0) return std::nullopt;
  writer.host = name.substr(dot + 1);
  return writer;
}

bool HasEnded(const Writer& writer) {
  if (::kill(writer.process, 0) != 0 && errno == ESRCH) return true;
  const uint64_t start = StartOf(writer.process);
  return start != 0 && writer.start != 0 && start != writer.start;
}

bool IsOfThisMachine(const Writer& writer) { return writer.host == HostPart(); }

}  // namespace

std::string HostName() {
  char host[HOST_NAME_MAX + 1] = "";
  ::gethostname(host, sizeof host - 1);
  return host;
}

std::string TemporaryName(std::string_view name) {
  static std::atomic<unsigned> number = 0;
  static const uint64_t start = StartOf(::getpid());
  return fmt::format(".{}.{}.{}.{}.{}{}", name.substr(0, kLongestShown), HostPart(), ::getpid(), start,
                     number++, kTemporaryEnding);
}

std::filesystem::path TemporaryBeside(const std::filesystem::path& path) {
  return path.parent_path() / TemporaryName(path.filename().string());
}

bool IsTemporaryName(std::string_view file_name) { return WriterOf(file_name).has_value(); }

bool IsOfEndedWriter(std::string_view file_name) {
  const std::optional<Writer> writer = WriterOf(file_name);
  return writer && IsOfThisMachine(*writer) && HasEnded(*writer);
}

bool IsOfNoWriterHere(std::string_view file_name) {
  const std::optional<Writer> writer = WriterOf(file_name);
  return writer && (!IsOfThisMachine(*writer) || HasEnded(*writer));
}

}  // namespace millpose
