// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/config/operations.hpp"

#include "job/config/setups.hpp"
#include "program/program_name.hpp"

namespace millpose::config {
namespace {

// What an operation may have of a job.
const std::vector<std::string> kSections = {
    "tool",         "toolpath", "process",         "pose",        "limits", "path",
    "interference", "gaps",     "program_options", "compensation"};
constexpr size_t kMost = 99;

// Of a section that an operation has not key by key.
bool IsWhole(const std::string& section) { return section == "toolpath" || section == "tool"; }

// `own` in place of what `map` has under `key`, or key by key where both are sections.
void Override(Value& map, const Value::Key& key, const Value& own) {
  Value* given = map.Find(key.text);
  const bool whole = IsWhole(key.text);
  if (!given) {
    map.keys.push_back(key);
    map.items.push_back(own);
  } else if (whole || given->kind != Value::Kind::kMap || own.kind != Value::Kind::kMap) {
    *given = own;
  } else {
    for (size_t i = 0; i < own.keys.size(); ++i) {
      if (Value* inner = given->Find(own.keys[i].text)) {
        *inner = own.items[i];
      } else {
        given->keys.push_back(own.keys[i]);
        given->items.push_back(own.items[i]);
      }
    }
  }
}

// A section of an operation may have any of its keys alone.
Value WithoutRequired(const Value& schema) {
  Value loose = Value::Map();
  for (size_t i = 0; i < schema.keys.size(); ++i)
    if (schema.keys[i].text != "required" && schema.keys[i].text != "anyOf" &&
        schema.keys[i].text != "default")
      loose.Put(schema.keys[i].text, schema.items[i]);
  return loose;
}

std::vector<FieldInfo> OperationKeys() {
  std::vector<FieldInfo> keys = {
      {"name", "text", "", "Name of the operation, and of its folder.", true, {}},
      {"setup", "text", "", "Which of the job's `setups`; required with them.", false, {}}};
  for (const std::string& section : kSections)
    keys.push_back({section,
                    section == "tool" ? "text" : "map",
                    "as the job's",
                    section == "tool" ? "Which of the cell's `tools`."
                    : section == "toolpath"
                        ? "In place of the job's own `toolpath`, as a whole."
                        : fmt::format("In place of the job's own `{}`, key by key.", section),
                    false,
                    {}});
  return keys;
}

// What the job has for all operations, and each of them has otherwise.
void RefuseUnused(const Value& root, const std::vector<Value>& operations, const Context& context) {
  const auto refuse = [&](const std::string& key, yaml::Mark mark, const auto& has_own) {
    if (std::ranges::all_of(operations, has_own))
      context.Add(mark, fmt::format("{} has no effect here: every operation has its own", key));
  };
  for (const std::string& section : kSections) {
    const Value* given = root.Find(section);
    if (!given) continue;
    if (IsWhole(section)) {
      refuse(section, root.FindKey(section)->mark,
             [&](const Value& operation) { return operation.Find(section) != nullptr; });
      continue;
    }
    for (const Value::Key& key : given->keys)
      refuse(section + "." + key.text, key.mark, [&](const Value& operation) {
        const Value* own = operation.Find(section);
        return own && own->Find(key.text);
      });
  }
}

// The tool that operation `number` names, or the job for all; empty where neither does.
std::string ToolOfOperation(const Value& root, size_t number) {
  const Value* own = root.Find("operations")->items[number].Find("tool");
  if (!own) own = root.Find("tool");
  return own && own->kind == Value::Kind::kScalar ? own->text : std::string();
}

}  // namespace

Field<JobSettings> OperationsField(const std::vector<Field<JobSettings>>& fields) {
  Field<JobSettings> field;
  field.info = {
      "operations",
      "list of maps",
      "",
      "One after the other on the same part, each planned as a job of its own (docs/operations.md).",
      false,
      {}};
  field.keys = OperationKeys;
  field.schema = [fields] {
    Value properties = Value::Map();
    properties.Put("name", WordSchema());
    properties.Put("setup", WordSchema());
    for (const Field<JobSettings>& own : fields)
      if (std::ranges::find(kSections, own.info.key) != kSections.end())
        properties.Put(own.info.key, own.info.key == "toolpath" ? own.DescribedSchema()
                                                                : WithoutRequired(own.DescribedSchema()));
    return NamedMapsSchema(properties, kMost);
  };
  field.read = [](const Value&, const Context&, JobSettings&) {};
  field.write = [](const JobSettings&) { return Value(); };
  return field;
}

void LeaveToOperations(Value& schema) {
  Value sections = Value::Map();
  Value& properties = *schema.Find("properties");
  for (const std::string& name : kSections) {
    Value* section = properties.Find(name);
    const Value::Key* key = section && !IsWhole(name) ? section->FindKey("required") : nullptr;
    if (!key) continue;
    Value required = Value::Map();
    required.Put("required", *section->Find("required"));
    sections.Put(name, std::move(required));
    const auto at = key - section->keys.data();
    section->keys.erase(section->keys.begin() + at);
    section->items.erase(section->items.begin() + at);
  }
  // The other choice beside `operations`: all is the job's own.
  schema.Find("allOf")->items.front().Find("anyOf")->items.back().Put("properties", std::move(sections));
}

std::vector<std::string> OperationNames(const Value& root, const Context& context) {
  const Value& list = *root.Find("operations");
  const Context at_list = context.Child("operations");
  std::vector<std::string> names;
  if (list.kind != Value::Kind::kList || list.items.empty() || list.items.size() > kMost) {
    at_list.AddWrong(list, fmt::format("a list of 1 to {} operations", kMost));
    return names;
  }
  for (size_t i = 0; i < list.items.size(); ++i) {
    const Value& item = list.items[i];
    const Context at = at_list.Child(i);
    if (item.kind != Value::Kind::kMap) {
      at.AddWrong(item, "a map of keys");
      continue;
    }
    codec_detail::CheckKeys(item, at, OperationKeys());
    const Value* name = item.Find("name");
    if (!name) continue;
    if (name->kind != Value::Kind::kScalar || !IsWord(name->text))
      at.Child("name").AddWrong(*name, "letters, digits and '_', at most 31, beginning with a letter");
    else if (std::ranges::find(names, name->text) != names.end())
      at.Child("name").Add(name->mark, fmt::format("given {} twice", name->text));
    names.push_back(name->text);
  }
  RefuseUnused(root, list.items, context);
  CheckSetups(root, names, context);
  return names;
}

Value OperationRoot(const Value& root, size_t number) {
  const Value& operation = root.Find("operations")->items[number];
  Value own = Value::Map();
  own.mark = root.mark;
  for (size_t i = 0; i < root.keys.size(); ++i) {
    if (root.keys[i].text == "operations" || root.keys[i].text == "setups") continue;
    own.keys.push_back(root.keys[i]);
    own.items.push_back(root.items[i]);
  }
  for (size_t i = 0; i < operation.keys.size(); ++i)
    if (operation.keys[i].text != "name" && operation.keys[i].text != "setup")
      Override(own, operation.keys[i], operation.items[i]);
  PlaceInSetup(root, number, own);
  const std::string operation_name = operation.Find("name")->text;
  own.Put("operation", Value::Text(operation_name));
  if (Value* name = own.Find("name"); name && name->kind == Value::Kind::kScalar) {
    const std::string job = std::exchange(name->text, OperationName(name->text, operation_name));
    own.Put("operation_of", Value::Text(job));
  }
  const std::string tool = ToolOfOperation(root, number);
  // The first of a setup may be begun on another day.
  if (number > 0 && !tool.empty() && tool == ToolOfOperation(root, number - 1) &&
      SetupOf(root, number) == SetupOf(root, number - 1))
    own.Put("tool_held", Value::Plain("true"));
  return own;
}

}  // namespace millpose::config
