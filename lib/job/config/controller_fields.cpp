// SPDX-License-Identifier: GPL-3.0-or-later
// A cell's `controllers:` section: every controller's own table (lib/program), and what is said of a key that
// only others know.
#include "job/config/fields.hpp"

namespace millpose::config {
namespace {

const FieldInfo* Find(const std::vector<FieldInfo>& keys, const std::string& key) {
  const auto found = std::ranges::find(keys, key, &FieldInfo::key);
  return found == keys.end() ? nullptr : &*found;
}

/// The keys of one controller at a place of its section.
struct Known {
  std::string controller;
  std::vector<FieldInfo> keys;
};

/// Takes out keys that this controller does not know but others do, and says who knows them.
void TakeOutForeign(Value& value, const Context& context, const Known& own, const std::vector<Known>& all) {
  if (value.kind == Value::Kind::kList)
    for (size_t i = 0; i < value.items.size(); ++i)
      TakeOutForeign(value.items[i], context.Child(i), own, all);
  if (value.kind != Value::Kind::kMap) return;
  Value kept = value;
  kept.keys.clear();
  kept.items.clear();
  for (size_t i = 0; i < value.items.size(); ++i) {
    const std::string& key = value.keys[i].text;
    const FieldInfo* info = Find(own.keys, key);
    std::vector<Known> inside;
    std::vector<std::string> names;
    for (const Known& other : all)
      if (const FieldInfo* known = Find(other.keys, key)) {
        inside.push_back({other.controller, known->keys});
        names.push_back(other.controller);
      }
    if (!info && !names.empty()) {
      const Context at = context.Child(key);
      const std::string* former = codec_detail::FormerKey(at.path);
      at.Add(value.keys[i].mark, former ? *former
                                        : fmt::format("{} programs do not know this; allowed for: {}",
                                                      own.controller, fmt::join(names, ", ")));
      continue;
    }
    if (info) TakeOutForeign(value.items[i], context.Child(key), {own.controller, info->keys}, inside);
    kept.keys.push_back(value.keys[i]);
    kept.items.push_back(value.items[i]);
  }
  value = kept;
}

}  // namespace

Codec<std::map<std::string, ControllerOptions>> ControllersFields() {
  using Controllers = std::map<std::string, ControllerOptions>;
  Codec<Controllers> codec;
  codec.type = "map of name to map";
  codec.schema = [] {
    Value schema = codec_detail::SchemaOf("object");
    Value properties = Value::Map();
    for (const PostEntry& entry : Posts().entries()) properties.Put(entry.name, entry.section.schema());
    schema.Put("properties", properties);
    schema.Put("additionalProperties", Value::Plain("false"));
    return schema;
  };
  codec.keys = [] {
    std::vector<FieldInfo> keys;
    for (const PostEntry& entry : Posts().entries())
      keys.push_back({entry.name, entry.section.type, "", "", false, KeysOf(entry.section.keys)});
    return keys;
  };
  codec.read = [keys = codec.keys](const Value& value, const Context& context, Controllers& result) {
    const std::vector<FieldInfo> known = keys();
    std::vector<Known> all;
    for (const FieldInfo& controller : known) all.push_back({controller.key, controller.keys});
    if (value.kind != Value::Kind::kMap) return context.AddWrong(value, "a map of keys");
    codec_detail::CheckKeys(value, context, known);
    result.clear();
    for (const Known& own : all) {
      const Value* given = value.Find(own.controller);
      if (!given) continue;
      Value section = *given;
      const Context child = context.Child(own.controller);
      TakeOutForeign(section, child, own, all);
      Posts().At(own.controller).section.read(section, child, result[own.controller]);
    }
  };
  codec.write = [](const Controllers& controllers) {
    Value map = Value::Map();
    for (const auto& [name, controller] : controllers)
      map.Put(name, Posts().At(name).section.write(controller));
    return map;
  };
  return codec;
}

}  // namespace millpose::config
