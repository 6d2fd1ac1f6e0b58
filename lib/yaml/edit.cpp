// SPDX-License-Identifier: GPL-3.0-or-later
#include "yaml/edit.hpp"

#include <fmt/format.h>

#include "base/error.hpp"

namespace millpose::yaml {
namespace {

/// The offset of (line, column), both from 1, columns in characters.
size_t OffsetOf(const std::string& text, const Mark& mark) {
  size_t at = 0;
  for (int line = 1; line < mark.line; ++line) at = text.find('\n', at) + 1;
  for (int column = 1; column < mark.column; ++at)
    if ((static_cast<unsigned char>(text[at + 1]) & 0xC0) != 0x80) ++column;
  return at;
}

/// Where the flow value or scalar that begins at `start` ends; npos where it is not in that line.
size_t EndOf(const std::string& text, size_t start) {
  const size_t line_end = std::min(text.find('\n', start), text.size());
  const char first = text[start];
  if (first == '|' || first == '>') return std::string::npos;
  if (first == '"' || first == '\'') {
    for (size_t at = start + 1; at < line_end; ++at) {
      if (text[at] == first) {
        if (first == '"' || text[at + 1] != first) return at + 1;
        ++at;  // '' is one quote
      } else if (first == '"' && text[at] == '\\') {
        ++at;
      }
    }
    return std::string::npos;
  }
  if (first == '[' || first == '{') {
    int depth = 0;
    for (size_t at = start; at < line_end; ++at) {
      if (text[at] == '#' && text[at - 1] == ' ') return std::string::npos;
      depth += text[at] == '[' || text[at] == '{';
      depth -= text[at] == ']' || text[at] == '}';
      if (depth == 0) return at + 1;
    }
    return std::string::npos;
  }
  size_t end = std::min(text.find(" #", start), line_end);
  while (end > start && text[end - 1] == ' ') --end;
  return end;
}

}  // namespace

std::string WithKey(const std::string& text, const std::string& name, const std::string& section,
                    const std::string& key, const std::string& value) {
  const Value root = ReadYaml(text, name);
  const Value* found = root.Find(section);
  if (!found || found->kind != Value::Kind::kMap || found->keys.empty())
    throw InputError({name}, fmt::format("{} is missing", section));
  std::string changed = text;
  if (const Value* old = found->Find(key)) {
    const size_t start = OffsetOf(text, old->mark), end = EndOf(text, start);
    const bool block = old->kind == Value::Kind::kMap || old->kind == Value::Kind::kList;
    if (end == std::string::npos || (block && text[start] != '[' && text[start] != '{'))
      throw InputError({name, old->mark.line},
                       fmt::format("{}.{}: allowed: a value in one line", section, key));
    return changed.replace(start, end - start, value);
  }
  const size_t first = OffsetOf(text, found->keys.front().mark);
  const size_t line = first == 0 ? 0 : text.rfind('\n', first - 1) + 1;
  const bool block = text.find_first_not_of(' ', line) == first;
  // In a section of braces, before its first key; else in a line of its own before that one.
  return changed.insert(first, block ? fmt::format("{}: {}\n{}", key, value, std::string(first - line, ' '))
                                     : fmt::format("{}: {}, ", key, value));
}

}  // namespace millpose::yaml
