// SPDX-License-Identifier: GPL-3.0-or-later
// The field table, one line per YAML key: a Field binds a key to a place in a settings struct, a Section is a
// list of Fields. From it come strict reading, writing, the JSON Schema and the reference page.
#pragma once

#include <memory>

#include "base/pose_settings.hpp"
#include "base/yaml/codec.hpp"

namespace millpose::yaml {

/// A key of a section: what it is called, says and stands for.
struct FieldText {
  FieldInfo info;  ///< without the keys below it; its default_text is what DefaultText() was given
  std::function<Value()> schema;                 ///< as CodecText::schema
  std::function<std::vector<FieldInfo>()> keys;  ///< as CodecText::keys
  std::function<Value()> default_value;          ///< none where there is none

  /// The schema with the key's description.
  Value DescribedSchema() const;
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
  /// What the reference page says in place of the struct's own default.
  Field DefaultText(std::string text) && {
    info.default_text = std::move(text);
    default_value = nullptr;
    return std::move(*this);
  }
};

namespace codec_detail {

/// A Field or a Codec without its type.
template <class Text>
struct Untyped {
  Text text;
  ReadAny read;
  WriteAny write;
};
using AnyField = Untyped<FieldText>;
using AnyCodec = Untyped<CodecText>;

/// A key whose value `codec` reads into the settings and writes from them.
AnyField MakeField(std::string key, AnyCodec codec, std::string doc, const void* defaults);
/// `codec` where the value lies at `place(settings)`.
AnyCodec Placed(AnyCodec codec, void* (*place)(void*));
AnyCodec SectionOf(std::vector<AnyField> fields, ReadAny check);
Value SectionSchema(const std::vector<FieldInfo>& keys, std::vector<Value> schemas,
                    const std::vector<Value>& defaults);

/// The settings as they are where nothing is given.
template <class S>
const S& DefaultsOf() {
  static const S defaults{};
  return defaults;
}

template <class S>
Field<S> Typed(AnyField any) {
  return {std::move(any.text), ReadOf<S>(std::move(any.read)), WriteOf<S>(std::move(any.write))};
}

}  // namespace codec_detail

/// `access` maps an S& to the place of the value (see MILLPOSE_AT).
template <class S, class Access, class T>
Field<S> Key(std::string key, Access, Codec<T> codec, std::string doc) {
  static_assert(std::is_same_v<decltype(Access{}(std::declval<S&>())), T&>,
                "the codec is of another type than the place");
  const auto place = [](void* settings) -> void* { return &Access{}(*static_cast<S*>(settings)); };
  return codec_detail::Typed<S>(codec_detail::MakeField(
      std::move(key),
      codec_detail::Placed({static_cast<CodecText&&>(codec), codec.read.any(), codec.write.any()}, place),
      std::move(doc), &codec_detail::DefaultsOf<S>()));
}

/// As Key(), for values that lie in the settings in another form.
template <class S, class T>
Field<S> KeyBy(std::string key, std::function<T(const S&)> get, std::function<void(S&, const T&)> set,
               Codec<T> codec, std::string doc) {
  const ReadOf<S> read = [get, set, read = codec.read](const Value& value, const Context& context,
                                                       S& settings) {
    const size_t problems_before = context.problems.size();
    T item = get(settings);
    read(value, context, item);
    if (context.problems.size() == problems_before) set(settings, item);
  };
  const WriteOf<S> write = [get, write = codec.write](const S& settings) { return write(get(settings)); };
  return codec_detail::Typed<S>(codec_detail::MakeField(std::move(key),
                                                        {std::move(codec), read.any(), write.any()},
                                                        std::move(doc), &codec_detail::DefaultsOf<S>()));
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
Codec<S> Section(std::vector<Field<S>> fields, const ReadOf<S>& check = {}) {
  std::vector<codec_detail::AnyField> any;
  for (Field<S>& field : fields)
    any.push_back({static_cast<FieldText&&>(field), field.read.any(), field.write.any()});
  codec_detail::AnyCodec section = codec_detail::SectionOf(std::move(any), check.any());
  return {std::move(section.text), ReadOf<S>(std::move(section.read)), WriteOf<S>(std::move(section.write))};
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
  std::vector<FieldInfo> known;
  for (const auto& [name, value, choice] : choices) known.push_back({name, choice.type, "", "", false, {}});
  const auto kept = std::make_shared<const std::vector<Alternative<S, Kind>>>(std::move(choices));
  codec.schema = [kept] {
    Value schema = codec_detail::SchemaOf("object");
    Value properties = Value::Map();
    for (const auto& [name, value, choice] : *kept) properties.Put(name, choice.schema());
    schema.Put("properties", properties);
    schema.Put("minProperties", Value::Plain("1"));
    schema.Put("maxProperties", Value::Plain("1"));
    schema.Put("additionalProperties", Value::Plain("false"));
    return schema;
  };
  codec.keys = [kept, known] {
    std::vector<FieldInfo> keys = known;
    for (size_t i = 0; i < keys.size(); ++i) keys[i].keys = KeysOf((*kept)[i].section.keys);
    return keys;
  };
  codec.read = [kind, kept, known](const Value& value, const Context& context, S& result) {
    std::vector<std::string> names;
    for (const FieldInfo& info : known) names.push_back(info.key);
    const std::string allowed = fmt::format("{}", fmt::join(names, ", "));
    if (value.kind != Value::Kind::kMap) return context.AddWrong(value, "one of the keys " + allowed);
    codec_detail::CheckKeys(value, context, known);
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
