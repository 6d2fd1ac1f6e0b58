// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text.hpp"
#include "base/yaml/value.hpp"

namespace millpose::yaml {

Value Value::Plain(std::string text) {
  Value value;
  value.kind = Kind::kScalar;
  value.text = std::move(text);
  return value;
}

Value Value::Text(std::string text) {
  Value value = Plain(std::move(text));
  value.plain = false;
  return value;
}

Value Value::List(std::vector<Value> items) {
  Value value;
  value.kind = Kind::kList;
  value.items = std::move(items);
  return value;
}

Value Value::Map() {
  Value value;
  value.kind = Kind::kMap;
  return value;
}

void Value::Put(std::string key, Value value) {
  keys.push_back({std::move(key), {}});
  items.push_back(std::move(value));
}

const Value* Value::Find(std::string_view key) const {
  const Key* found = FindKey(key);
  return found ? &items[static_cast<size_t>(found - keys.data())] : nullptr;
}

Value* Value::Find(std::string_view key) {
  const Key* found = FindKey(key);
  return found ? &items[static_cast<size_t>(found - keys.data())] : nullptr;
}

const Value::Key* Value::FindKey(std::string_view key) const {
  const auto found = std::ranges::find(keys, key, &Key::text);
  return found == keys.end() ? nullptr : &*found;
}

namespace {

constexpr size_t kLineWidth = 100;

// JSON's quoting, which YAML's double quotes understand as well.
std::string Quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (c == '\t') {
      result += "\\t";
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      result += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    } else {
      result += c;
    }
  }
  return result + '"';
}

// Words that stay text without quotes for every YAML reader; the YAML 1.1 names of true, false and null do
// not.
bool NeedsQuotes(std::string_view text) {
  static const std::vector<std::string> kSpecial{"y", "n", "yes", "no", "on", "off", "true", "false", "null"};
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto is_safe = [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || std::string_view(" ./-;()+").find(c) != text.npos;
  };
  const bool starts_well = !text.empty() && (is_letter(text[0]) || text.starts_with("../"));
  if (!starts_well || text.ends_with(' ') || !std::ranges::all_of(text, is_safe)) return true;
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return std::ranges::find(kSpecial, lower) != kSpecial.end();
}

std::string Scalar(const Value& value) {
  if (value.kind == Value::Kind::kNull) return "null";
  return value.plain || !NeedsQuotes(value.text) ? value.text : Quoted(value.text);
}

std::string KeyText(const std::string& key) { return NeedsQuotes(key) ? Quoted(key) : key; }

void WriteBlock(const Value& value, size_t indent, std::string& out);

// An entry after its "key:" or "-": on the same line when it fits, else as a block below.
void WriteEntry(const Value& value, size_t indent, size_t prefix, bool top, std::string& out) {
  const bool scalar = value.kind == Value::Kind::kNull || value.kind == Value::Kind::kScalar;
  const std::string line = WriteYamlLine(value);
  const bool section = top && value.kind == Value::Kind::kMap;
  if (scalar || value.items.empty() || (!section && indent + prefix + line.size() <= kLineWidth)) {
    out += ' ' + line + '\n';
    return;
  }
  out += '\n';
  WriteBlock(value, indent + 2, out);
}

void WriteBlock(const Value& value, size_t indent, std::string& out) {
  for (size_t i = 0; i < value.items.size(); ++i) {
    out.append(indent, ' ');
    const std::string head = value.kind == Value::Kind::kMap ? KeyText(value.keys[i].text) + ':' : "-";
    out += head;
    WriteEntry(value.items[i], indent, head.size() + 1, indent == 0, out);
  }
}

void WriteJsonAt(const Value& value, size_t indent, std::string& out) {
  const bool map = value.kind == Value::Kind::kMap;
  if (value.kind == Value::Kind::kNull || value.kind == Value::Kind::kScalar) {
    out += value.kind == Value::Kind::kNull ? "null" : value.plain ? value.text : Quoted(value.text);
    return;
  }
  const auto is_leaf = [](const Value& item) { return item.items.empty(); };
  if (value.items.empty() || (!map && std::ranges::all_of(value.items, is_leaf))) {
    out += map ? '{' : '[';
    for (size_t i = 0; i < value.items.size(); ++i) {
      if (i > 0) out += ", ";
      WriteJsonAt(value.items[i], indent, out);
    }
    out += map ? '}' : ']';
    return;
  }
  out += map ? "{\n" : "[\n";
  for (size_t i = 0; i < value.items.size(); ++i) {
    out.append(indent + 2, ' ');
    if (map) out += Quoted(value.keys[i].text) + ": ";
    WriteJsonAt(value.items[i], indent + 2, out);
    out += i + 1 < value.items.size() ? ",\n" : "\n";
  }
  out.append(indent, ' ');
  out += map ? '}' : ']';
}

}  // namespace

std::string WriteYamlLine(const Value& value) {
  if (value.kind != Value::Kind::kList && value.kind != Value::Kind::kMap) return Scalar(value);
  const bool map = value.kind == Value::Kind::kMap;
  std::string line(1, map ? '{' : '[');
  for (size_t i = 0; i < value.items.size(); ++i) {
    if (i > 0) line += ", ";
    if (map) line += KeyText(value.keys[i].text) + ": ";
    line += WriteYamlLine(value.items[i]);
  }
  return line + (map ? '}' : ']');
}

std::string WriteYaml(const Value& value) {
  std::string out;
  if (value.items.empty()) return WriteYamlLine(value) + '\n';
  WriteBlock(value, 0, out);
  return out;
}

std::string WriteJson(const Value& value) {
  std::string out;
  WriteJsonAt(value, 0, out);
  return out + '\n';
}

}  // namespace millpose::yaml
