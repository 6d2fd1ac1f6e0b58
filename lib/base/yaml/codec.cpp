// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/yaml/codec.hpp"

#include <algorithm>

#include "base/shown.hpp"
#include "base/text.hpp"
#include "base/units.hpp"

namespace millpose::yaml {

// Known before anything runs: registries take them while their programs start.
constinit const Unit kOne{"", 1, 1}, kMm{"mm", 1, 1}, kDeg{"deg", kRadPerDeg, 1},
    kDegPerS{"deg/s", kRadPerDeg, 1}, kDegPerS2{"deg/s²", kRadPerDeg, 1}, kNmPerRad{"N·m/rad", 1000, 1},
    kMmPerMin{"mm/min", 1, 60}, kRevPerMin{"rev/min", 1, 60}, kPercent{"%", 1, 100};

namespace {

std::string Given(const Value& value) {
  switch (value.kind) {
    case Value::Kind::kNull:
      return "nothing";
    case Value::Kind::kScalar:
      return value.plain ? Shown(value.text) : fmt::format("the text \"{}\"", Shown(value.text));
    case Value::Kind::kList:
      return fmt::format("a list of {}", value.items.size());
    case Value::Kind::kMap:
      return "a map";
  }
  return "";
}

size_t SkipDigits(std::string_view text, size_t i) {
  while (i < text.size() && IsDigit(text[i])) ++i;
  return i;
}

// 1, -1.5, 1e-5: what YAML 1.1, YAML 1.2 and JSON read alike. 010, .5, +1, 0x1f, 1_000 are read differently.
bool IsNumber(std::string_view text) {
  size_t i = text.starts_with('-') ? 1 : 0;
  const size_t integer_end = SkipDigits(text, i);
  if (integer_end == i || (text[i] == '0' && integer_end - i > 1)) return false;
  i = integer_end;
  if (i < text.size() && text[i] == '.') {
    const size_t end = SkipDigits(text, i + 1);
    if (end == i + 1) return false;
    i = end;
  }
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    ++i;
    if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
    const size_t end = SkipDigits(text, i);
    if (end == i) return false;
    i = end;
  }
  return i == text.size();
}

bool LooksLikeOtherType(std::string_view text) {
  static const std::vector<std::string_view> kWords{"true",  "false", "True", "False", "TRUE",
                                                    "FALSE", ".nan",  ".inf", "-.inf"};
  return ParseNumber(text).has_value() || std::ranges::find(kWords, text) != kWords.end();
}

std::string Describe(const Range& range) {
  if (range.lower == range.upper) return fmt::format(" {}", range.lower);
  if (range.lower_open) return fmt::format(" > {}, ≤ {}", range.lower, range.upper);
  return fmt::format(" {}…{}", range.lower, range.upper);
}

bool Contains(const Range& range, double value) {
  return value >= range.lower && value <= range.upper && !(range.lower_open && value == range.lower);
}

std::string NumberType(const std::string& noun, const Unit& unit, const Range& range) {
  return noun + Describe(range) + (unit.label.empty() ? "" : fmt::format(", {}", unit.label));
}

Value NumberSchema(const std::string& type, const Range& range) {
  Value schema = codec_detail::SchemaOf(type);
  schema.Put(range.lower_open ? "exclusiveMinimum" : "minimum", Value::Plain(ShortestNumber(range.lower)));
  schema.Put("maximum", Value::Plain(ShortestNumber(range.upper)));
  return schema;
}

}  // namespace

Context Context::Child(const std::string& key) const {
  return {file, problems, path.empty() ? Shown(key) : path + '.' + Shown(key)};
}

Context Context::Child(size_t index) const { return {file, problems, fmt::format("{}[{}]", path, index)}; }

void Context::Add(const Mark& mark, const std::string& message) const {
  problems.push_back({{file, mark.line, mark.column}, path.empty() ? message : path + ": " + message});
  if (problems.size() > kMostProblems) throw InputError(std::move(problems));
}

void Context::AddWrong(const Value& given, const std::string& allowed) const {
  Add(given.mark, fmt::format("given {}; allowed: {}", Given(given), allowed));
}

std::string ShortestIn(const Unit& unit, double inside) {
  const auto to_inside = [&](double external) { return external * unit.factor / unit.divisor; };
  const double external = inside * unit.divisor / unit.factor;
  for (int digits = 1; digits <= 17; ++digits) {
    const std::optional<double> rounded = ParseNumber(fmt::format("{:.{}g}", external, digits));
    if (rounded && to_inside(*rounded) == inside) return ShortestNumber(*rounded);
  }
  // Undoing the conversion may miss by a unit in the last place; a neighbour then converts back exactly.
  double below = external, above = external;
  for (int i = 0; i < 4; ++i) {
    below = std::nextafter(below, -std::numeric_limits<double>::infinity());
    above = std::nextafter(above, std::numeric_limits<double>::infinity());
    for (const double near : {below, above})
      if (to_inside(near) == inside) return ShortestNumber(near);
  }
  return ShortestNumber(external);
}

Codec<double> Real(const Unit& unit, const Range& range) {
  Codec<double> codec;
  codec.type = NumberType("number", unit, range);
  codec.schema = [range] { return NumberSchema("number", range); };
  codec.read = [unit, range, type = codec.type](const Value& value, const Context& context, double& result) {
    if (value.kind != Value::Kind::kScalar || !value.plain || !IsNumber(value.text))
      return context.AddWrong(value, type + " (written like 1, 1.5 or 1e-5)");
    const std::optional<double> number = ParseNumber(value.text);
    if (!number || !Contains(range, *number)) return context.AddWrong(value, type);
    result = *number * unit.factor / unit.divisor;
  };
  codec.write = [unit](double value) { return Value::Plain(ShortestIn(unit, value)); };
  return codec;
}

namespace {

template <class T>
Codec<T> WholeNumber(double lower, double upper) {
  const Range range = Between(lower, upper);
  Codec<T> codec;
  codec.type = NumberType("integer", kOne, range);
  codec.schema = [range] { return NumberSchema("integer", range); };
  codec.read = [range, type = codec.type](const Value& value, const Context& context, T& result) {
    const bool integer = value.kind == Value::Kind::kScalar && value.plain && IsNumber(value.text) &&
                         value.text.find_first_of(".eE") == std::string::npos;
    const std::optional<double> number = integer ? ParseNumber(value.text) : std::nullopt;
    if (!number || !Contains(range, *number)) return context.AddWrong(value, type);
    result = static_cast<T>(*number);
  };
  codec.write = [](T value) { return Value::Plain(fmt::format("{}", value)); };
  return codec;
}

bool IsControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }

Codec<std::string> TextOf(std::string type, bool lines) {
  Codec<std::string> codec;
  codec.type = std::move(type);
  codec.schema = [lines] {
    Value schema = codec_detail::SchemaOf("string");
    if (!lines) schema.Put("minLength", Value::Plain("1"));
    return schema;
  };
  codec.read = [type = codec.type, lines](const Value& value, const Context& context, std::string& result) {
    if (value.kind != Value::Kind::kScalar || (value.plain && LooksLikeOtherType(value.text)))
      return context.AddWrong(value, type + " (in quotes when it looks like a number, true or false)");
    if (!lines && (value.text.empty() || value.text.find('\n') != std::string::npos))
      return context.AddWrong(value, type);
    if (std::ranges::any_of(value.text, [&](char c) {
          return IsControl(c) && c != '\n' && c != '\t' && !(lines && c == '\r');
        }))
      return context.AddWrong(value, type + " without control characters");
    result = value.text;
  };
  codec.write = [](const std::string& text) { return Value::Text(text); };
  return codec;
}

constexpr size_t kLongestName = 100;  // with what is put behind it, file systems allow 255

bool IsFileName(const std::string& name) {
  return !name.empty() && name.size() <= kLongestName && name.find_first_of("/\\") == std::string::npos &&
         !name.starts_with('-') && !name.starts_with('.') && std::ranges::none_of(name, IsControl) &&
         ValidUtf8(name) == name;
}

}  // namespace

Codec<int> Integer(int lower, int upper) { return WholeNumber<int>(lower, upper); }
Codec<uint64_t> Seed() { return WholeNumber<uint64_t>(0, 9007199254740992.0); }
Codec<std::string> Text() { return TextOf("text of one line", false); }
Codec<std::string> Lines() { return TextOf("text", true); }

Codec<std::string> FileName() {
  Codec<std::string> codec = TextOf("name that a file can have", false);
  codec.schema = [text = codec.schema] {
    Value schema = text();
    schema.Put("maxLength", Value::Plain(std::to_string(kLongestName)));
    schema.Put("pattern", Value::Text(R"(^[^-./\\][^/\\]*$)"));
    return schema;
  };
  codec.read = [text = codec.read](const Value& value, const Context& context, std::string& result) {
    std::string name;
    const size_t problems_before = context.problems.size();
    text(value, context, name);
    if (context.problems.size() != problems_before) return;
    if (!IsFileName(name))
      return context.AddWrong(
          value, fmt::format("a name that a file can have: 1 to {} bytes of UTF-8, no / or \\, no "
                             "control characters, no - or . in front",
                             kLongestName));
    result = name;
  };
  return codec;
}

Codec<bool> Flag() {
  Codec<bool> codec;
  codec.type = "true or false";
  codec.schema = [] { return codec_detail::SchemaOf("boolean"); };
  codec.read = [type = codec.type](const Value& value, const Context& context, bool& result) {
    const bool scalar = value.kind == Value::Kind::kScalar && value.plain;
    if (!scalar || (value.text != "true" && value.text != "false")) return context.AddWrong(value, type);
    result = value.text == "true";
  };
  codec.write = [](bool value) { return Value::Plain(value ? "true" : "false"); };
  return codec;
}

Codec<std::string> Choice(std::vector<std::string> names) {
  Codec<std::string> codec;
  codec.type = "one of " + fmt::format("{}", fmt::join(names, ", "));
  codec.schema = [names] {
    Value schema = codec_detail::SchemaOf("string");
    Value list = Value::List();
    for (const std::string& name : names) list.items.push_back(Value::Text(name));
    schema.Put("enum", std::move(list));
    return schema;
  };
  codec.read = [names, type = codec.type](const Value& value, const Context& context, std::string& result) {
    if (value.kind == Value::Kind::kScalar && std::ranges::find(names, value.text) != names.end()) {
      result = value.text;
      return;
    }
    const std::string near = value.kind == Value::Kind::kScalar ? NearestName(value.text, names) : "";
    context.AddWrong(value, near.empty() ? type : type + "; nearest: " + near);
  };
  codec.write = [](const std::string& text) { return Value::Text(text); };
  return codec;
}

namespace codec_detail {

Value SchemaOf(const std::string& type) {
  Value schema = Value::Map();
  schema.Put("type", Value::Text(type));
  return schema;
}

Value ListSchema(const Value& item, size_t least, size_t most) {
  Value schema = SchemaOf("array");
  schema.Put("items", item);
  if (most > 0) {
    schema.Put("minItems", Value::Plain(std::to_string(least)));
    schema.Put("maxItems", Value::Plain(std::to_string(most)));
  }
  return schema;
}

}  // namespace codec_detail
}  // namespace millpose::yaml
