// SPDX-License-Identifier: GPL-3.0-or-later
#include "wrapped.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <optional>

#include "report/words/word_table.hpp"

namespace millpose {
namespace {

constexpr size_t kTextColumn = 11;  // where what a line says begins

/// Of the terminal that stdout is, without the last: a line that fills it moves the cursor on.
std::optional<size_t> OutputColumns() {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col <= 2 * kTextColumn) return std::nullopt;
  return size.ws_col - 1;
}

/// One line, broken; `used` columns of the first are taken already, `indent` of those after it are blank.
std::string WrappedLine(std::string_view line, size_t columns, size_t used, size_t indent) {
  std::string wrapped;
  bool first = true;  // of its line
  for (size_t at = 0; at < line.size();) {
    const size_t end = std::min(line.find(' ', at), line.size());
    const std::string_view word = line.substr(at, end - at);
    const size_t width = ColumnsOf(word);
    if (!first && used + 1 + width > columns) {
      wrapped += '\n' + std::string(indent, ' ');
      used = indent;
      first = true;
    }
    if (!first) wrapped += ' ', ++used;
    wrapped += word;
    used += width;
    first = false;
    at = end + 1;
  }
  return wrapped;
}

}  // namespace

std::string Wrapped(const std::string& text, size_t columns) {
  std::string wrapped;
  for (const std::string_view line : LinesOf(text)) wrapped += WrappedLine(line, columns, 0, 0) + '\n';
  if (!text.ends_with('\n') && !wrapped.empty()) wrapped.pop_back();
  return wrapped;
}

std::string ForTerminal(const std::string& text) {
  const std::optional<size_t> columns = OutputColumns();
  if (!columns) return text;
  std::string wrapped;
  for (const std::string_view line : LinesOf(text)) {
    const size_t begin = std::min(line.find_first_not_of(' ', line.find(' ')), line.size());
    const std::string_view label = line.substr(0, begin);
    wrapped +=
        std::string(label) + WrappedLine(line.substr(begin), *columns, ColumnsOf(label), kTextColumn) + '\n';
  }
  return wrapped;
}

}  // namespace millpose
