// SPDX-License-Identifier: GPL-3.0-or-later
// The field table, one line per YAML key: a Field binds a key to a place in a settings struct, a Section is a
// list of Fields. From it come strict reading, writing, the JSON Schema and the reference page.
#pragma once

#include <memory>

#include "base/pose_settings.hpp"
#include "base/yaml/codec.hpp"

namespace millpose::yaml {

namespace codec_detail {
Value SectionSchema(const std::vector<FieldInfo>& keys, std::vector<Value> schemas,
                    const std::vector<Value>& defaults);
}  // namespace codec_detail

/// A key of a section whose settings are an S.
template <class S>
struct Field {
  FieldInfo info;
  std::function<void(const Value&, const Context&, S&)> read;
  std::function<Value(const S&)> write;
  Value schema;
  Value default_value;

  /// The key must be given.
  Field Required() && {
    info.required = true;
    return std::move(*this);
  }
  /// The key must be given where `other` is not.
  Field RequiredUnless(std::string other) && {
    info.required_unless = std::move(other);
    return std::move(*this).DefaultText("");
  }
  /// Written only where `is_set` holds; missing by default.
  Field WhenSet(std::function<bool(const S&)> is_set) && {
    write = [is_set, inner = write](const S& settings) {
      return is_set(settings) ? inner(settings) : Value();
    };
    return std::move(*this).DefaultText("");
  }
  /// What the reference page says in place of the struct's own default.
  Field DefaultText(std::string text) && {
    info.default_text = std::move(text);
    default_value = Value();
    return std::move(*this);
  }
};

/// As Key(); made once for each pair of types, not for each key.
template <class S, class T>
Field<S> KeyAt(std::string key, T& (*place)(S&), Codec<T> codec, std::string doc) {
  const auto of = [place](const S& settings) -> const T& { return place(const_cast<S&>(settings)); };
  Field<S> field;
  field.info = {std::move(key), std::move(codec.type), "", std::move(doc), false, std::move(codec.keys)};
  field.schema = std::move(codec.schema);
  field.schema.Put("description", Value::Text(field.info.doc));
  field.default_value = codec.write(of(S{}));
  if (field.info.keys.empty() && field.default_value.kind != Value::Kind::kNull)
    field.info.default_text = WriteYamlLine(field.default_value);
  field.read = [place, read = codec.read](const Value& value, const Context& context, S& settings) {
    read(value, context, place(settings));
  };
  field.write = [of, write = codec.write](const S& settings) { return write(of(settings)); };
  return field;
}

/// `access` maps an S& to the place of the value (see MILLPOSE_AT).
template <class S, class Access, class T>
Field<S> Key(std::string key, Access, Codec<T> codec, std::string doc) {
  return KeyAt<S, T>(
      std::move(key), [](S& settings) -> T& { return Access{}(settings); }, std::move(codec), std::move(doc));
}

/// As Key(), for values that lie in the settings in another form.
template <class S, class T>
Field<S> KeyBy(std::string key, std::function<T(const S&)> get, std::function<void(S&, const T&)> set,
               Codec<T> codec, std::string doc) {
  Field<S> field;
  field.info = {std::move(key), codec.type, "", std::move(doc), false, codec.keys};
  field.schema = codec.schema;
  field.schema.Put("description", Value::Text(field.info.doc));
  field.default_value = codec.write(get(S{}));
  if (field.default_value.kind != Value::Kind::kNull)
    field.info.default_text = WriteYamlLine(field.default_value);
  field.read = [get, set, read = codec.read](const Value& value, const Context& context, S& settings) {
    const size_t problems_before = context.problems.size();
    T item = get(settings);
    read(value, context, item);
    if (context.problems.size() == problems_before) set(settings, item);
  };
  field.write = [get, write = codec.write](const S& settings) { return write(get(settings)); };
  return field;
}

/// The key that says which version of the format a file has.
template <class S>
Field<S> VersionKey(std::string key, int version) {
  return KeyBy<S, int>(
             std::move(key), [version](const S&) { return version; }, [](S&, const int&) {},
             Integer(version, version), "Version of this format.")
      .Required();
}

/// The place `path` of a settings struct: MILLPOSE_AT(toolpath.stepover).
#define MILLPOSE_AT(path) \
  [](auto& settings) -> auto& { return settings.path; }
/// The settings struct itself, for sections whose keys lie in their parent's struct.
inline constexpr auto kSelf = [](auto& settings) -> auto& { return settings; };

/// A map with these keys. `check` sees the settings when all keys were good.
template <class S>
Codec<S> Section(std::vector<Field<S>> fields,
                 std::function<void(const Value&, const Context&, S&)> check = nullptr) {
  Codec<S> codec;
  codec.type = "map";
  std::vector<Value> schemas, defaults;
  for (Field<S>& field : fields) {
    defaults.push_back(field.info.keys.empty() ? std::move(field.default_value) : Value());
    schemas.push_back(std::move(field.schema));
    codec.keys.push_back(field.info);
    field.info.keys.clear();
  }
  codec.schema = codec_detail::SectionSchema(codec.keys, std::move(schemas), defaults);
  // Shared: sections lie in sections, and each would copy all that is below it.
  const auto kept = std::make_shared<const std::vector<Field<S>>>(std::move(fields));
  const auto keys = std::make_shared<const std::vector<FieldInfo>>(codec.keys);
  codec.read = [kept, keys, check](const Value& value, const Context& context, S& settings) {
    const size_t problems_before = context.problems.size();
    if (value.kind != Value::Kind::kMap) return context.AddWrong(value, "a map of keys");
    codec_detail::CheckKeys(value, context, *keys);
    for (const Field<S>& field : *kept)
      if (const Value* item = value.Find(field.info.key))
        field.read(*item, context.Child(field.info.key), settings);
    if (check && context.problems.size() == problems_before) check(value, context, settings);
  };
  codec.write = [kept](const S& settings) {
    Value map = Value::Map();
    for (const Field<S>& field : *kept) {
      Value item = field.write(settings);
      if (item.kind != Value::Kind::kNull) map.Put(field.info.key, std::move(item));
    }
    return map;
  };
  return codec;
}

/// One of the sections that OneOf() chooses from.
template <class S, class Kind>
struct Alternative {
  std::string name;
  Kind kind;
  Codec<S> section;
};

/// One of several sections by its only key, which says what `kind` is.
template <class S, class Kind>
Codec<S> OneOf(Kind S::*kind, std::vector<Alternative<S, Kind>> choices) {
  Codec<S> codec;
  codec.type = "map with one key";
  codec.schema = codec_detail::SchemaOf("object");
  Value properties = Value::Map();
  std::string allowed;
  for (const auto& [name, value, choice] : choices) {
    properties.Put(name, choice.schema);
    codec.keys.push_back({name, choice.type, "", "", false, choice.keys});
    allowed += (allowed.empty() ? "" : ", ") + name;
  }
  codec.schema.Put("properties", properties);
  codec.schema.Put("minProperties", Value::Plain("1"));
  codec.schema.Put("maxProperties", Value::Plain("1"));
  codec.schema.Put("additionalProperties", Value::Plain("false"));
  const auto kept = std::make_shared<const std::vector<Alternative<S, Kind>>>(std::move(choices));
  const auto keys = std::make_shared<const std::vector<FieldInfo>>(codec.keys);
  codec.read = [kind, kept, allowed, keys](const Value& value, const Context& context, S& result) {
    if (value.kind != Value::Kind::kMap) return context.AddWrong(value, "one of the keys " + allowed);
    codec_detail::CheckKeys(value, context, *keys);
    if (value.items.size() != 1)
      return context.Add(value.mark,
                         fmt::format("given {} keys; allowed: one of {}", value.items.size(), allowed));
    for (const auto& [name, chosen, choice] : *kept)
      if (value.keys[0].text == name) {
        result.*kind = chosen;
        choice.read(value.items[0], context.Child(name), result);
      }
  };
  codec.write = [kind, kept](const S& settings) {
    Value map = Value::Map();
    for (const auto& [name, value, choice] : *kept)
      if (settings.*kind == value) map.Put(name, choice.write(settings));
    return map.items.empty() ? Value() : map;
  };
  return codec;
}

/// {xyz_mm, abc_deg}.
Codec<PoseSettings> PoseFields();

}  // namespace millpose::yaml
