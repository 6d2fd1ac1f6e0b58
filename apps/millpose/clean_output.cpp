// SPDX-License-Identifier: GPL-3.0-or-later
#include "clean_output.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>

#include "base/utf8.hpp"
#include "wrapped.hpp"

namespace millpose {
namespace {

/// Where the bytes of a stream go.
struct Target {
  int file;
  std::string rest = {};
  bool as_is = false;  ///< no line is broken
};

Target to_stdout{STDOUT_FILENO}, to_stderr{STDERR_FILENO};

/// How many bytes a character has that begins with `first`; 1 where none does.
size_t LengthBy(unsigned char first) {
  return first >= 0xF0 && first <= 0xF4 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 1;
}

/// C0 but line feed and tab, DEL, C1; marks, embeddings, overrides and isolates of the direction of text.
bool IsCommand(std::string_view character) {
  const auto byte = [&](size_t i) { return static_cast<unsigned char>(character[i]); };
  if (character.size() == 1) return (byte(0) < 0x20 && byte(0) != '\n' && byte(0) != '\t') || byte(0) == 0x7F;
  if (character.size() == 2) return (byte(0) == 0xC2 && byte(1) < 0xA0) || character == "\xD8\x9C";
  if (character.size() != 3 || byte(0) != 0xE2) return false;
  return (byte(1) == 0x80 && (byte(2) == 0x8E || byte(2) == 0x8F || (byte(2) >= 0xAA && byte(2) <= 0xAE))) ||
         (byte(1) == 0x81 && byte(2) >= 0xA6 && byte(2) <= 0xA9);
}

bool WriteAll(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    bytes.remove_prefix(static_cast<size_t>(count));
  }
  return true;
}

ssize_t WriteClean(void* cookie, const char* bytes, size_t count) {
  auto& target = *static_cast<Target*>(cookie);
  std::string clean = Cleaned({bytes, count}, target.rest);
  if (!target.as_is) clean = ForTerminal(clean, target.file);
  return WriteAll(target.file, clean) ? static_cast<ssize_t>(count) : 0;
}

/// Text is written whole, so that no line comes in two pieces, of which neither would be too wide.
using Buffer = std::array<char, 1 << 18>;

/// A stream to the target; the plain one where there is no memory for it.
FILE* StreamTo(Target& target, FILE* plain, int buffering, Buffer& buffer) {
  FILE* stream = ::fopencookie(&target, "w", {nullptr, &WriteClean, nullptr, nullptr});
  if (!stream) return plain;
  std::setvbuf(stream, buffer.data(), buffering, buffer.size());
  return stream;
}

}  // namespace

std::string Cleaned(std::string_view text, std::string& rest) {
  const std::string joined = std::exchange(rest, {}) + std::string(text);
  std::string clean;
  clean.reserve(joined.size());
  for (std::string_view left = joined; !left.empty();) {
    const size_t length = Utf8Length(left);
    if (length == 0 && left.size() < LengthBy(static_cast<unsigned char>(left[0]))) {
      rest = left;  // perhaps the rest of it comes with the next text
      break;
    }
    const std::string_view character = left.substr(0, std::max<size_t>(length, 1));
    clean += length == 0 || IsCommand(character) ? std::string_view("?") : character;
    left.remove_prefix(character.size());
  }
  return clean;
}

void CleanOutput() {
  static Buffer out_buffer, error_buffer;
  stdout = StreamTo(to_stdout, stdout, ::isatty(STDOUT_FILENO) != 0 ? _IOLBF : _IOFBF, out_buffer);
  stderr = StreamTo(to_stderr, stderr, _IOLBF, error_buffer);
}

void PrintAsIs(const std::string& text) {
  std::fflush(stdout);
  to_stdout.as_is = true;
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
  to_stdout.as_is = false;
}

void ClearLine() {
  if (::isatty(STDERR_FILENO) == 0) return;
  std::fflush(stderr);
  WriteAll(STDERR_FILENO, "\r\x1b[K");
}

}  // namespace millpose
