// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/yaml/edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/error.hpp"

namespace millpose::yaml {
namespace {

/// The offset of (line, column), both from 1, columns in characters.
size_t OffsetOf(const std::string& text, const Mark& mark) {
  size_t at = mark.line == 1 && text.starts_with("\xef\xbb\xbf") ? 3 : 0;  // a byte order mark has no column
  for (int line = 1; line < mark.line; ++line) at = text.find('\n', at) + 1;
  for (int column = 1; column < mark.column; ++at)
    if ((static_cast<unsigned char>(text[at + 1]) & 0xC0) != 0x80) ++column;
  return at;
}

/// Where the quotes that begin at `start` end; npos where they do not before `line_end`.
size_t EndOfQuotes(const std::string& text, size_t start, size_t line_end) {
  const char quote = text[start];
  for (size_t at = start + 1; at < line_end; ++at) {
    if (text[at] == quote) {
      if (quote == '"' || text[at + 1] != quote) return at + 1;
      ++at;  // '' is one quote
    } else if (quote == '"' && text[at] == '\\') {
      ++at;
    }
  }
  return std::string::npos;
}

/// Where the brackets that begin at `start` end, likewise.
size_t EndOfBrackets(const std::string& text, size_t start, size_t line_end) {
  int depth = 0;
  for (size_t at = start; at < line_end; ++at) {
    const char c = text[at];
    if (c == '#' && text[at - 1] == ' ') return std::string::npos;
    if ((c == '"' || c == '\'') && std::string_view(" [{,:").find(text[at - 1]) != std::string_view::npos) {
      at = EndOfQuotes(text, at, line_end);
      if (at == std::string::npos) return at;
      --at;
    }
    depth += c == '[' || c == '{';
    depth -= c == ']' || c == '}';
    if (depth == 0) return at + 1;
  }
  return std::string::npos;
}

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// Where the flow value or scalar that begins at `start` ends; npos where it is not in that line.
/// `in_braces`: of a section in braces, where a bare word ends sooner.
size_t EndOf(const std::string& text, size_t start, bool in_braces) {
  const size_t line_end = std::min(text.find('\n', start), text.size());
  const char first = text[start];
  if (first == '|' || first == '>') return std::string::npos;
  if (first == '"' || first == '\'') return EndOfQuotes(text, start, line_end);
  if (first == '[' || first == '{') return EndOfBrackets(text, start, line_end);
  size_t end = start;
  while (end < line_end && !(text[end] == '#' && IsBlank(text[end - 1])) &&
         !(in_braces && (text[end] == ',' || text[end] == '}')))
    ++end;
  while (end > start && IsBlank(text[end - 1])) --end;
  return end;
}

/// How the line that holds `at` ends, or, in a last line without an end, the one before.
std::string LineEnd(const std::string& text, size_t at) {
  size_t end = text.find('\n', at);
  if (end == std::string::npos) end = text.rfind('\n');
  return end != std::string::npos && end > 0 && text[end - 1] == '\r' ? "\r\n" : "\n";
}

/// Whether two trees say the same, wherever they stand.
bool Same(const Value& a, const Value& b) {
  if (a.kind != b.kind || a.text != b.text || a.keys.size() != b.keys.size()) return false;
  for (size_t i = 0; i < a.keys.size(); ++i)
    if (a.keys[i].text != b.keys[i].text) return false;
  return std::ranges::equal(a.items, b.items, Same);
}

/// Takes section.key out of the tree; null where it is not there.
Value Take(Value& root, const std::string& section, const std::string& key) {
  Value* found = root.Find(section);
  if (!found) return {};
  for (size_t i = 0; i < found->keys.size(); ++i) {
    if (found->keys[i].text != key) continue;
    Value taken = std::move(found->items[i]);
    found->keys.erase(found->keys.begin() + static_cast<std::ptrdiff_t>(i));
    found->items.erase(found->items.begin() + static_cast<std::ptrdiff_t>(i));
    return taken;
  }
  return {};
}

/// Whether `changed` says what `before` said, but `value` under section.key.
bool SaysOnly(const std::string& changed, Value before, const std::string& section, const std::string& key,
              const std::string& value) {
  try {
    Value after = ReadYaml(changed, ""), wanted = ReadYaml(value, "");
    Take(before, section, key);
    return Same(Take(after, section, key), wanted) && Same(after, before);
  } catch (const InputError&) {
    return false;
  }
}

/// The text with `value` in place of `old`, or as a key before all others of `section` where that is null;
/// none where `old` does not stand in one line.
std::optional<std::string> Edited(const std::string& text, const Value& section, const Value* old,
                                  const std::string& key, const std::string& value) {
  const size_t first = OffsetOf(text, section.keys.front().mark);
  const bool in_braces = text[OffsetOf(text, section.mark)] == '{';
  std::string changed = text;
  if (old) {
    const size_t start = OffsetOf(text, old->mark), end = EndOf(text, start, in_braces);
    const bool block = old->kind == Value::Kind::kMap || old->kind == Value::Kind::kList;
    if (old->kind == Value::Kind::kNull || end == std::string::npos ||
        (block && text[start] != '[' && text[start] != '{'))
      return std::nullopt;
    return changed.replace(start, end - start, value);
  }
  if (in_braces) return changed.insert(first, fmt::format("{}: {}, ", key, value));
  const size_t line = first == 0 ? 0 : text.rfind('\n', first - 1) + 1;
  return changed.insert(
      first, fmt::format("{}: {}{}{}", key, value, LineEnd(text, first), std::string(first - line, ' ')));
}

}  // namespace

std::string WithKey(const std::string& text, const std::string& name, const std::string& section,
                    const std::string& key, const std::string& value) {
  const Value root = ReadYaml(text, name);
  const Value* found = root.Find(section);
  if (!found || found->kind != Value::Kind::kMap || found->keys.empty())
    throw InputError({name}, fmt::format("{} is missing", section));
  const Value* old = found->Find(key);
  const std::optional<std::string> changed = Edited(text, *found, old, key, value);
  if (!changed)
    throw InputError({name, old->mark.line},
                     fmt::format("{}.{}: allowed: a value in one line", section, key));
  if (!SaysOnly(*changed, root, section, key, value))
    throw InputError({name, old ? old->mark.line : found->mark.line},
                     fmt::format("{}.{}: cannot be changed without changing more; write it by hand: {}",
                                 section, key, value));
  return *changed;
}

}  // namespace millpose::yaml
