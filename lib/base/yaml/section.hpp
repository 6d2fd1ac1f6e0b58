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

/// A key of a section: what it is called, says and stands for.
struct FieldText {
  FieldInfo info;
  Value schema;
  Value default_value;

  FieldText();
  FieldText(const FieldText&);
  FieldText(FieldText&&) noexcept;
  FieldText& operator=(const FieldText&);
  FieldText& operator=(FieldText&&) noexcept;
  ~FieldText();
  /// What the reference page says in place of the struct's own default.
  void SayDefault(std::string text);
};

/// A key of a section whose settings are an S.
template <class S>
struct Field : FieldText {
  ReadOf<S> read;
  WriteOf<S> write;

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
  /// See SayDefault().
  Field DefaultText(std::string text) && {
    SayDefault(std::move(text));
    return std::move(*this);
  }
};

namespace codec_detail {

/// A function from the address of settings to that of a value in them.
using Place = void* (*)(void*);
using AnyRead = ReadOf<int>::Any;
using AnyWrite = WriteOf<int>::Any;

/// A Field without its types.
struct AnyField {
  FieldText text;
  AnyRead read;
  AnyWrite write;
};
AnyField FieldAt(std::string key, Place place, CodecText codec, AnyRead read, AnyWrite write, std::string doc,
                 const void* defaults);

/// A section's Codec without its type.
struct AnySection {
  CodecText text;
  AnyRead read;
  AnyWrite write;
};
AnySection SectionOf(std::vector<AnyField> fields, AnyRead check);

/// The settings as they are where nothing is given.
template <class S>
const S& DefaultsOf() {
  static const S defaults{};
  return defaults;
}

}  // namespace codec_detail

/// `access` maps an S& to the place of the value (see MILLPOSE_AT).
template <class S, class Access, class T>
Field<S> Key(std::string key, Access, Codec<T> codec, std::string doc) {
  static_assert(std::is_same_v<decltype(Access{}(std::declval<S&>())), T&>,
                "the codec is of another type than the place");
  codec_detail::AnyField any = codec_detail::FieldAt(
      std::move(key), [](void* settings) -> void* { return &Access{}(*static_cast<S*>(settings)); },
      std::move(codec), codec.read.AnyOne(), codec.write.AnyOne(), std::move(doc),
      &codec_detail::DefaultsOf<S>());
  return {std::move(any.text), ReadOf<S>::From(std::move(any.read)), WriteOf<S>::From(std::move(any.write))};
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
Codec<S> Section(std::vector<Field<S>> fields, ReadOf<S> check = {}) {
  std::vector<codec_detail::AnyField> any;
  for (Field<S>& field : fields) any.push_back({std::move(field), field.read.AnyOne(), field.write.AnyOne()});
  codec_detail::AnySection section = codec_detail::SectionOf(std::move(any), check.AnyOne());
  return {std::move(section.text), ReadOf<S>::From(std::move(section.read)),
          WriteOf<S>::From(std::move(section.write))};
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
