// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace millpose::yaml {

/// Place in a text, both counted from 1 (columns in characters, not bytes); 0 = unknown.
struct Mark {
  int line = 0;
  int column = 0;
};

/// A tree of null, scalars, lists and maps: what a YAML or JSON text says before it means anything.
struct Value {
  enum class Kind : uint8_t { kNull, kScalar, kList, kMap };
  struct Key {
    std::string text;
    Mark mark;
  };

  Kind kind = Kind::kNull;
  Mark mark;
  std::string text;          ///< of a scalar
  bool plain = true;         ///< scalar without quotes: a number, true, false, or a bare word
  std::vector<Key> keys;     ///< of a map, one for each of `items`, in the text's order
  std::vector<Value> items;  ///< of a list or a map

  static Value Plain(std::string text);
  static Value Text(std::string text);
  static Value List(std::vector<Value> items = {});
  static Value Map();

  /// Appends an entry to a map.
  void Put(std::string key, Value value);
  /// The entry of a map under `key`, or null.
  const Value* Find(std::string_view key) const;
  Value* Find(std::string_view key);
  const Key* FindKey(std::string_view key) const;
};

/// Reads one YAML document. Throws InputError for what is not YAML and for what this project refuses:
/// anchors, aliases, tags, merge keys, duplicate keys, keys that are no words, further documents, tabs in
/// indentation, control characters, quoted text over several lines, more than 32 levels, 500,000 keys and
/// values or 4 MB.
Value ReadYaml(std::string_view text, const std::string& name);

/// The tree as YAML block style; what fits into a line is written in one. Reads back to the same tree.
std::string WriteYaml(const Value& value);

/// The tree in one line of YAML flow style.
std::string WriteYamlLine(const Value& value);

/// The tree as JSON, indented by two blanks.
std::string WriteJson(const Value& value);

}  // namespace millpose::yaml
