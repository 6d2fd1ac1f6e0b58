// SPDX-License-Identifier: GPL-3.0-or-later
#include "wrapped.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <optional>

#include "report/words/word_table.hpp"

namespace millpose {
namespace {

constexpr size_t kTextColumn = 11;  // where what a line says begins, unless two blanks show it
constexpr size_t kLastTextColumn = 24;

/// Of the terminal that `file` is, without the last: a line that fills it moves the cursor on.
std::optional<size_t> OutputColumns(int file) {
  winsize size{};
  if (::ioctl(file, TIOCGWINSZ, &size) != 0 || size.ws_col <= 2 * kLastTextColumn) return std::nullopt;
  return size.ws_col - 1;
}

/// Where what the line says begins: behind its first word and the blanks that put the text into a column.
size_t TextColumn(std::string_view line) {
  const size_t word = std::min(line.find_first_not_of(' '), line.size());
  const size_t gap = std::min(line.find("  ", word), line.size());
  const size_t text = std::min(line.find_first_not_of(' ', gap), line.size());
  const size_t column = ColumnsOf(line.substr(0, text));
  return text < line.size() && column <= kLastTextColumn ? column : kTextColumn;
}

/// Of JSON, that somebody may copy.
bool IsJson(std::string_view line) {
  const size_t first = line.find_first_not_of(' ');
  return first != std::string_view::npos &&
         std::string_view("{}[]\"").find(line[first]) != std::string_view::npos;
}

/// One line, broken; `indent` columns of the lines after the first are blank.
std::string WrappedLine(std::string_view line, size_t columns, size_t indent) {
  std::string wrapped;
  size_t used = 0;    // columns of its line
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
  for (const std::string_view line : LinesOf(text)) wrapped += WrappedLine(line, columns, 0) + '\n';
  if (!text.ends_with('\n') && !wrapped.empty()) wrapped.pop_back();
  return wrapped;
}

std::string ForTerminal(const std::string& text, int file) {
  const std::optional<size_t> columns = OutputColumns(file);
  if (!columns) return text;
  std::string wrapped;
  for (const std::string_view line : LinesOf(text)) {
    const bool fits = ColumnsOf(line) <= *columns || IsJson(line);
    wrapped += fits ? std::string(line) : WrappedLine(line, *columns, TextColumn(line));
    wrapped += '\n';
  }
  if (!text.ends_with('\n') && !wrapped.empty()) wrapped.pop_back();
  return wrapped;
}

}  // namespace millpose
