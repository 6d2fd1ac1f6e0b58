// SPDX-License-Identifier: GPL-3.0-or-later
// A Codec knows one type of value: how it is read strictly, written, and described in the JSON Schema and on
// the reference page.
#pragma once

#include <fmt/format.h>

#include <Eigen/Dense>
#include <array>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/enum_words.hpp"
#include "base/error.hpp"
#include "base/yaml/value.hpp"

namespace millpose::yaml {

using Six = Eigen::Matrix<double, 6, 1>;

/// Where the reader is: collects problems and knows the key's path.
struct Context {
  const std::string& file;
  std::vector<Problem>& problems;
  std::string path;

  Context Child(const std::string& key) const;
  Context Child(size_t index) const;
  /// "path: message" at `mark`.
  void Add(const Mark& mark, const std::string& message) const;
  /// "path: given …; allowed: …".
  void AddWrong(const Value& given, const std::string& allowed) const;
};

/// One key as the reference page shows it.
struct FieldInfo {
  std::string key, type, default_text, doc;
  bool required = false;
  std::vector<FieldInfo> keys;       ///< of a section
  std::string required_unless = {};  ///< required where none of these keys, "urdf, dh", is given
};

/// Reading into, and writing, what lies at an address.
using ReadAny = std::function<void(const Value&, const Context&, void*)>;
using WriteAny = std::function<Value(const void*)>;

/// Reads a value into a T. What is inside does not name T, so that sections and their keys, of some hundred
/// types, are compiled once.
template <class T>
class ReadOf {
 public:
  ReadOf() = default;
  explicit ReadOf(ReadAny any) : any_(std::move(any)) {}
  /// An empty std::function stays one.
  template <class Function>
  requires std::is_invocable_v<Function&, const Value&, const Context&, T&> ReadOf(
      Function function) {  // NOLINT(google-explicit-constructor): any function is one
    if constexpr (std::is_convertible_v<std::nullptr_t, Function>)
      if (function == nullptr) return;
    any_ = [function = std::move(function)](const Value& value, const Context& context, void* result) {
      function(value, context, *static_cast<T*>(result));
    };
  }
  void operator()(const Value& value, const Context& context, T& result) const {
    any_(value, context, &result);
  }
  const ReadAny& any() const { return any_; }

 private:
  ReadAny any_;
};

/// Writes a T; see ReadOf.
template <class T>
class WriteOf {
 public:
  WriteOf() = default;
  explicit WriteOf(WriteAny any) : any_(std::move(any)) {}
  template <class Function>
  requires std::is_invocable_r_v<Value, Function&, const T&> WriteOf(
      Function function)  // NOLINT(google-explicit-constructor): any function is one
      : any_([function = std::move(function)](const void* given) -> Value {
          return function(*static_cast<const T*>(given));
        }) {}
  Value operator()(const T& given) const { return any_(&given); }
  const WriteAny& any() const { return any_; }

 private:
  WriteAny any_;
};

/// What a Codec says of its type. Reading needs the first alone, so the others are made when they are asked
/// for.
struct CodecText {
  std::string type;                              ///< what is allowed, for people: "number > 0, mm"
  std::function<Value()> schema;                 ///< JSON Schema
  std::function<std::vector<FieldInfo>()> keys;  ///< of a section; none where it has no keys of its own
};

/// What `keys` (CodecText::keys) makes; nothing where it is none.
inline std::vector<FieldInfo> KeysOf(const std::function<std::vector<FieldInfo>()>& keys) {
  return keys ? keys() : std::vector<FieldInfo>();
}

/// How values of type T are read, written and described.
template <class T>
struct Codec : CodecText {
  ReadOf<T> read;    ///< leaves T alone where a problem is added
  WriteOf<T> write;  ///< null: leave the key out
};

/// External unit: inside = external · factor ÷ divisor (one of them is 1, so that writing can undo it).
struct Unit {
  std::string_view label;  ///< a literal
  double factor = 1, divisor = 1;
};
extern const Unit kOne, kMm, kDeg, kDegPerS, kDegPerS2, kNmPerRad, kMmPerMin, kRevPerMin, kPercent;

/// Allowed numbers in the external unit. Every number has two ends: what no machine, part or process can
/// have is a slip of the keyboard or of the unit.
struct Range {
  double lower, upper;
  bool lower_open = false;  ///< the lower end itself is not allowed
};
inline Range Between(double lower, double upper) { return {lower, upper}; }
inline Range UpTo(double upper) { return {0, upper}; }
inline Range Positive(double upper) { return {0, upper, true}; }

Codec<double> Real(const Unit& unit, const Range& range);
Codec<int> Integer(int lower, int upper);
/// 0 … 2^53, which JSON readers keep exactly.
Codec<uint64_t> Seed();
Codec<bool> Flag();
Codec<std::string> Text();
/// Text that may hold several lines, for templates.
Codec<std::string> Lines();
/// A name that files are called by: what would lead out of their folder, or be taken for an option, is none.
Codec<std::string> FileName();
Codec<std::string> Choice(std::vector<std::string> names);
/// A point, mm, within a kilometre.
Codec<Eigen::Vector3d> Coordinates();
Codec<Eigen::Vector3d> Numbers3(const Unit& unit, const Range& range);
Codec<Six> Numbers6(const Unit& unit, const Range& range);
/// Three numbers, not all zero; made a unit vector.
Codec<Eigen::Vector3d> Direction();
/// Six signs, each 1 or -1.
Codec<std::array<int, 6>> Signs();
/// Six pairs [lower, upper], lower < upper, deg.
Codec<std::array<Six, 2>> Limits();
/// A pair of texts.
Codec<std::pair<std::string, std::string>> NamePair();

/// The shortest decimal that Real(unit) reads back to exactly `inside`.
std::string ShortestIn(const Unit& unit, double inside);

namespace codec_detail {
Value SchemaOf(const std::string& type);
/// `most` 0: of any length.
Value ListSchema(const Value& item, size_t least = 0, size_t most = 0);
/// What is said of a key of earlier versions, by its path; null where it is none.
const std::string* FormerKey(const std::string& path);
/// Adds a problem for every key of `map` that is not known, and for every known one that is missing.
void CheckKeys(const Value& map, const Context& context, const std::vector<FieldInfo>& known);
}  // namespace codec_detail

/// A name for each value of an enum.
template <class T>
Codec<T> ChoiceOf(std::vector<std::pair<std::string, T>> choices) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) names.push_back(name);
  const Codec<std::string> inner = Choice(std::move(names));
  Codec<T> codec;
  codec.type = inner.type;
  codec.schema = inner.schema;
  codec.read = [choices, read = inner.read](const Value& given, const Context& context, T& result) {
    std::string chosen;
    read(given, context, chosen);
    for (const auto& [name, value] : choices)
      if (name == chosen) result = value;
  };
  codec.write = [choices, write = inner.write](const T& chosen) {
    for (const auto& [name, value] : choices)
      if (value == chosen) return write(name);
    return Value();
  };
  return codec;
}

/// The same of an enum's table of words.
template <class T, size_t kCount>
Codec<T> ChoiceOf(const EnumWords<T, kCount>& words) {
  return ChoiceOf<T>(std::vector<std::pair<std::string, T>>(words.begin(), words.end()));
}

/// A value that may be missing.
template <class T>
Codec<std::optional<T>> Maybe(Codec<T> inner) {
  Codec<std::optional<T>> codec;
  codec.type = inner.type;
  codec.schema = inner.schema;
  codec.keys = inner.keys;
  codec.read = [read = inner.read](const Value& value, const Context& context, std::optional<T>& result) {
    T item{};
    const size_t problems_before = context.problems.size();
    read(value, context, item);
    if (context.problems.size() == problems_before) result = std::move(item);
  };
  codec.write = [write = inner.write](const std::optional<T>& item) { return item ? write(*item) : Value(); };
  return codec;
}

/// The word auto, which is none, or a value.
template <class T>
Codec<std::optional<T>> AutoOr(Codec<T> inner) {
  Codec<std::optional<T>> codec = Maybe(inner);
  codec.type = "auto or " + inner.type;
  codec.schema = [schema = inner.schema] {
    Value automatic = Value::Map();
    automatic.Put("const", Value::Text("auto"));
    Value choice = Value::Map();
    choice.Put("anyOf", Value::List({automatic, schema()}));
    return choice;
  };
  codec.read = [type = codec.type, read = codec.read](const Value& value, const Context& context,
                                                      std::optional<T>& result) {
    if (value.kind == Value::Kind::kScalar && value.text == "auto")
      result = std::nullopt;
    else if (value.kind != Value::Kind::kScalar || !value.plain)
      context.AddWrong(value, type);
    else
      read(value, context, result);
  };
  codec.write = [write = inner.write](const std::optional<T>& item) {
    return item ? write(*item) : Value::Text("auto");
  };
  return codec;
}

/// A list of any length; `count` > 0 fixes it.
template <class T>
Codec<std::vector<T>> ListOf(Codec<T> inner) {
  Codec<std::vector<T>> codec;
  codec.type = "list of: " + inner.type;
  codec.schema = [item = inner.schema] { return codec_detail::ListSchema(item()); };
  codec.keys = inner.keys;
  codec.read = [read = inner.read](const Value& value, const Context& context, std::vector<T>& result) {
    if (value.kind != Value::Kind::kList) return context.AddWrong(value, "a list");
    result.clear();
    for (size_t i = 0; i < value.items.size(); ++i)
      read(value.items[i], context.Child(i), result.emplace_back());
  };
  codec.write = [write = inner.write](const std::vector<T>& items) {
    Value list = Value::List();
    for (const T& item : items) list.items.push_back(write(item));
    return list;
  };
  return codec;
}

/// A map whose keys are names: those of `names`, or any when it is empty.
template <class T>
Codec<std::map<std::string, T>> MapOf(std::vector<std::string> names, Codec<T> inner) {
  Codec<std::map<std::string, T>> codec;
  codec.type = "map of name to " + inner.type;
  std::vector<FieldInfo> known;
  for (const std::string& name : names) known.push_back({name, inner.type, "", "", false, {}});
  codec.schema = [names, item = inner.schema] {
    Value schema = codec_detail::SchemaOf("object");
    Value properties = Value::Map();
    for (const std::string& name : names) properties.Put(name, item());
    if (!names.empty()) schema.Put("properties", properties);
    schema.Put("additionalProperties", names.empty() ? item() : Value::Plain("false"));
    return schema;
  };
  if (!names.empty())
    codec.keys = [known, keys = inner.keys] {
      std::vector<FieldInfo> all = known;
      for (FieldInfo& info : all) info.keys = KeysOf(keys);
      return all;
    };
  codec.read = [known, read = inner.read](const Value& value, const Context& context,
                                          std::map<std::string, T>& result) {
    if (value.kind != Value::Kind::kMap) return context.AddWrong(value, "a map of keys");
    if (!known.empty()) codec_detail::CheckKeys(value, context, known);
    result.clear();
    for (size_t i = 0; i < value.items.size(); ++i)
      read(value.items[i], context.Child(value.keys[i].text), result[value.keys[i].text]);
  };
  codec.write = [write = inner.write](const std::map<std::string, T>& items) {
    Value map = Value::Map();
    for (const auto& [name, item] : items) map.Put(name, write(item));
    return map;
  };
  return codec;
}

}  // namespace millpose::yaml
