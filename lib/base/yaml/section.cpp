// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/yaml/section.hpp"

#include <map>

#include "base/text.hpp"

namespace millpose::yaml::codec_detail {

namespace {

/// Keys of earlier versions, as the ends of their paths, and what stands in their place.
const std::map<std::string, std::string>& FormerKeys() {
  static const std::map<std::string, std::string> keys = {
      {".curve.direction",
       "is no longer a key: give project_along, the direction of looking, which is the opposite one: the "
       "line "
       "goes onto the first face that it meets"},
      {".ersysroot.axis",
       "is no longer a key: give coupled: true in external_axes to the axis that is the carriage"},
      {"controllers.sinumerik.rotation",
       "is no longer a key: give orientation_words: {names: [A2, B2, C2], group: orirpy}; rpy is orirpy, "
       "euler is "
       "orieuler"},
      {".motion",
       "is no longer a key: KRL cuts are LIN with C_DIS, SLINs stop at every corner of a SPLINE block"},
      {".motion_weight",
       "is no longer a key: give path.motion_share, the cost of one rad² of joint motion as a share of the "
       "median optimum of the pass's points, whatever the objective's unit; 1e-5 mm/N of chen2021 was a "
       "share "
       "of about 0.04, the default"},
  };
  return keys;
}

/// "urdf, dh": the keys one by one.
std::vector<std::string> Names(std::string_view list) {
  std::vector<std::string> names;
  for (size_t at = 0; at < list.size();) {
    const size_t end = std::min(list.find(", ", at), list.size());
    names.emplace_back(list.substr(at, end - at));
    at = end + 2;
  }
  return names;
}

}  // namespace

const std::string* FormerKey(const std::string& path) {
  for (const auto& [end, message] : FormerKeys())
    if (('.' + path).ends_with(end)) return &message;
  return nullptr;
}

void CheckKeys(const Value& map, const Context& context, const std::vector<FieldInfo>& known) {
  std::vector<std::string> names;
  for (const FieldInfo& info : known) names.push_back(info.key);
  for (const Value::Key& key : map.keys) {
    if (std::ranges::find(names, key.text) != names.end()) continue;
    const auto with_unit = std::ranges::find_if(
        names, [&](const std::string& name) { return name.starts_with(key.text + '_'); });
    const std::string near = NearestName(key.text, names);
    const Context at_key = context.Child(key.text);
    if (const std::string* former = FormerKey(at_key.path))
      at_key.Add(key.mark, *former);
    else if (with_unit != names.end())
      at_key.Add(key.mark, fmt::format("the key lacks its unit; nearest known key: {}", *with_unit));
    else if (!near.empty())
      at_key.Add(key.mark, "unknown key; nearest known key: " + near);
    else
      at_key.Add(key.mark, fmt::format("unknown key; allowed: {}", fmt::join(names, ", ")));
  }
  for (const FieldInfo& info : known) {
    if (map.Find(info.key)) continue;
    if (info.required)
      context.Child(info.key).Add(map.mark, "missing; required: " + info.type);
    else if (!info.required_unless.empty() &&
             std::ranges::none_of(Names(info.required_unless),
                                  [&](const std::string& other) { return map.Find(other); }))
      context.Child(info.key).Add(map.mark,
                                  fmt::format("missing; required without {}: {}",
                                              fmt::join(Names(info.required_unless), " or "), info.type));
  }
}

Value SectionSchema(const std::vector<FieldInfo>& keys, std::vector<Value> schemas,
                    const std::vector<Value>& defaults) {
  Value schema = SchemaOf("object");
  Value properties = Value::Map();
  Value required = Value::List();
  std::map<std::string, Value> unless;  // keys that are required where none of others is given
  for (size_t i = 0; i < keys.size(); ++i) {
    if (!keys[i].required_unless.empty())
      unless[keys[i].required_unless].items.push_back(Value::Text(keys[i].key));
    if (keys[i].required) required.items.push_back(Value::Text(keys[i].key));
    if (!keys[i].required && defaults[i].kind != Value::Kind::kNull) schemas[i].Put("default", defaults[i]);
    properties.Put(keys[i].key, std::move(schemas[i]));
  }
  schema.Put("properties", std::move(properties));
  if (!required.items.empty()) schema.Put("required", std::move(required));
  std::vector<Value> conditions;
  for (auto& [others, list] : unless) {
    Value choice = Value::List();
    for (const std::string& other : Names(others)) {
      Value with = Value::Map();
      with.Put("required", Value::List({Value::Text(other)}));
      choice.items.push_back(with);
    }
    Value without = Value::Map(), condition = Value::Map();
    list.kind = Value::Kind::kList;
    without.Put("required", list);
    choice.items.push_back(without);
    condition.Put("anyOf", choice);
    conditions.push_back(condition);
  }
  if (!conditions.empty()) schema.Put("allOf", Value::List(std::move(conditions)));
  schema.Put("additionalProperties", Value::Plain("false"));
  return schema;
}

AnyField MakeField(std::string key, AnyCodec codec, std::string doc, const void* defaults) {
  AnyField field;
  field.read = std::move(codec.read);
  field.write = std::move(codec.write);
  field.text = {{std::move(key), std::move(codec.text.type), "", std::move(doc), false, {}},
                std::move(codec.text.schema),
                std::move(codec.text.keys),
                [write = field.write, defaults] { return write(defaults); }};
  return field;
}

AnyCodec Placed(AnyCodec codec, void* (*place)(void*)) {
  codec.read = [place, read = std::move(codec.read)](const Value& value, const Context& context,
                                                     void* settings) {
    read(value, context, place(settings));
  };
  codec.write = [place, write = std::move(codec.write)](const void* settings) {
    return write(place(const_cast<void*>(settings)));
  };
  return codec;
}

namespace {

Value DefaultOf(const FieldText& text) { return text.default_value ? text.default_value() : Value(); }

/// With the keys below it and its default as text; what a section has by default stands at its keys.
FieldInfo WholeInfo(const FieldText& text) {
  FieldInfo info = text.info;
  info.keys = KeysOf(text.keys);
  const Value value = DefaultOf(text);
  if (value.kind == Value::Kind::kScalar || (!text.keys && value.kind != Value::Kind::kNull))
    info.default_text = WriteYamlLine(value);
  return info;
}

Value SchemaOfFields(const std::vector<AnyField>& fields) {
  std::vector<FieldInfo> keys;
  std::vector<Value> schemas, defaults;
  for (const AnyField& field : fields) {
    keys.push_back(field.text.info);
    schemas.push_back(field.text.DescribedSchema());
    defaults.push_back(field.text.keys ? Value() : DefaultOf(field.text));
  }
  return SectionSchema(keys, std::move(schemas), defaults);
}

}  // namespace

AnyCodec SectionOf(std::vector<AnyField> fields, ReadAny check) {
  // Shared: sections lie in sections, and each would copy all that is below it.
  const auto kept = std::make_shared<const std::vector<AnyField>>(std::move(fields));
  AnyCodec section;
  section.text.type = "map";
  section.text.schema = [kept] { return SchemaOfFields(*kept); };
  section.text.keys = [kept] {
    std::vector<FieldInfo> keys;
    for (const AnyField& field : *kept) keys.push_back(WholeInfo(field.text));
    return keys;
  };
  section.read = [kept, check = std::move(check)](const Value& value, const Context& context,
                                                  void* settings) {
    const size_t problems_before = context.problems.size();
    if (value.kind != Value::Kind::kMap) return context.AddWrong(value, "a map of keys");
    std::vector<FieldInfo> keys;
    for (const AnyField& field : *kept) keys.push_back(field.text.info);
    CheckKeys(value, context, keys);
    for (const AnyField& field : *kept)
      if (const Value* item = value.Find(field.text.info.key))
        field.read(*item, context.Child(field.text.info.key), settings);
    if (check && context.problems.size() == problems_before) check(value, context, settings);
  };
  section.write = [kept](const void* settings) {
    Value map = Value::Map();
    for (const AnyField& field : *kept) {
      Value item = field.write(settings);
      if (item.kind != Value::Kind::kNull) map.Put(field.text.info.key, std::move(item));
    }
    return map;
  };
  return section;
}

}  // namespace millpose::yaml::codec_detail

namespace millpose::yaml {

Value FieldText::DescribedSchema() const {
  Value described = schema();
  described.Put("description", Value::Text(info.doc));
  return described;
}

Codec<PoseSettings> PoseFields() {
  using S = PoseSettings;
  return Section<S>({
      Key<S>("xyz_mm", MILLPOSE_AT(position), Coordinates(), "Origin."),
      Key<S>("abc_deg", MILLPOSE_AT(abc), Numbers3(kDeg, Between(-360, 360)),
             "A about Z, then B about the new Y, then C about the new X."),
  });
}

}  // namespace millpose::yaml
