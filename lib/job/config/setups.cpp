// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/config/setups.hpp"

#include "base/error.hpp"

namespace millpose::config {
namespace {

constexpr size_t kMostSetups = 9;

// Of the workpiece: what differs from setup to setup.
const std::vector<std::string> kPlaceKeys = {"frame",        "pose",       "targets", "max_residual_mm",
                                             "registration", "registered", "fixtures"};

std::vector<FieldInfo> SetupKeys() {
  std::vector<FieldInfo> keys = {{"name", "text", "", "Name of the setup.", true, {}}};
  for (const std::string& key : kPlaceKeys)
    keys.push_back({key,
                    key == "frame" || key == "max_residual_mm" ? "as workpiece." + key : "map",
                    "",
                    fmt::format("As `workpiece.{}`, for the operations of this setup.", key),
                    false,
                    {}});
  keys[3].type = keys.back().type = "list of maps";
  return keys;
}

const Value* ScalarAt(const Value& map, const char* key) {
  const Value* found = map.kind == Value::Kind::kMap ? map.Find(key) : nullptr;
  return found && found->kind == Value::Kind::kScalar ? found : nullptr;
}

// The names of the setups that have one, each with its place.
std::vector<std::pair<std::string, yaml::Mark>> ReadSetups(const Value& list,
                                                           const std::vector<std::string>& operations,
                                                           const Context& context) {
  std::vector<std::pair<std::string, yaml::Mark>> names;
  for (size_t i = 0; i < list.items.size(); ++i) {
    const Value& item = list.items[i];
    const Context at = context.Child(i);
    if (item.kind != Value::Kind::kMap) {
      at.AddWrong(item, "a map of keys");
      continue;
    }
    codec_detail::CheckKeys(item, at, SetupKeys());
    if ((item.Find("pose") != nullptr) == (item.Find("targets") != nullptr))
      at.Add(item.mark, "give either pose or targets");
    const Value* name = item.Find("name");
    if (!name) continue;
    const Context at_name = at.Child("name");
    if (name->kind != Value::Kind::kScalar || !IsWord(name->text)) {
      at_name.AddWrong(*name, "letters, digits and '_', at most 31, beginning with a letter");
      continue;
    }
    if (std::ranges::any_of(names, [&](const auto& known) { return known.first == name->text; }))
      at_name.Add(name->mark, fmt::format("given {} twice", name->text));
    if (std::ranges::find(operations, name->text) != operations.end())
      at_name.Add(name->mark,
                  fmt::format("given {}; an operation has this name, and their programs would take "
                              "each other's place",
                              name->text));
    names.emplace_back(name->text, name->mark);
  }
  return names;
}

// Each operation is of one of the setups, and those of one follow each other.
class OperationsOfSetups {
 public:
  OperationsOfSetups(const std::vector<std::pair<std::string, yaml::Mark>>& setups, const Context& context)
      : setups_(setups), context_(context), used_(setups.size(), 0) {
    for (const auto& [name, mark] : setups) names_.push_back(name);
  }

  void Check(const Value& operations) {
    for (size_t i = 0; i < operations.items.size(); ++i)
      if (operations.items[i].kind == Value::Kind::kMap)
        CheckOne(operations.items[i], context_.Child("operations").Child(i));
    // A name that is missing or misspelt is told alone: its setup is not one too many.
    for (size_t i = 0; all_known_ && i < setups_.size(); ++i)
      if (used_[i] == 0)
        context_.Child("setups").Child(i).Child("name").Add(
            setups_[i].second, fmt::format("no operation is of setup {}", setups_[i].first));
  }

 private:
  void CheckOne(const Value& operation, const Context& at) {
    const Value* given = operation.Find("setup");
    if (!given) {
      all_known_ = false;
      at.Child("setup").Add(operation.mark,
                            fmt::format("missing; allowed, the job's setups: {}", fmt::join(names_, ", ")));
      return;
    }
    const auto found = std::ranges::find(names_, given->text);
    if (given->kind != Value::Kind::kScalar || found == names_.end()) {
      all_known_ = false;
      const std::string nearest = NearestName(given->text, names_);
      at.Child("setup").Add(
          given->mark,
          fmt::format("given {}; allowed, the job's setups: {}{}", given->text, fmt::join(names_, ", "),
                      nearest.empty() ? "" : "; did you mean " + nearest + "?"));
      return;
    }
    const auto index = static_cast<size_t>(found - names_.begin());
    used_[index] = 1;
    if (index < last_)
      at.Child("setup").Add(
          given->mark,
          fmt::format(
              "given {} after {}; allowed: operations in the order of the setups, {}: a part that was "
              "taken out does not stand as it did before; give it a setup of its own",
              *found, names_[last_], fmt::join(names_, ", ")));
    last_ = std::max(last_, index);
  }

  const std::vector<std::pair<std::string, yaml::Mark>>& setups_;
  const Context& context_;
  std::vector<std::string> names_;
  std::vector<char> used_;
  bool all_known_ = true;
  size_t last_ = 0;
};

const Value* SetupNamed(const Value& root, const std::string& name) {
  for (const Value& setup : root.Find("setups")->items)
    if (const Value* own = ScalarAt(setup, "name"); own && own->text == name) return &setup;
  return nullptr;
}

}  // namespace

Field<JobSettings> SetupsField(const std::vector<Field<JobSettings>>& fields) {
  const auto workpiece = std::ranges::find_if(
      fields, [](const Field<JobSettings>& field) { return field.info.key == "workpiece"; });
  Field<JobSettings> field;
  field.info = {
      "setups", "list of maps",
      "",       "Where the part stands, one after the other; each operation names its own (docs/setups.md).",
      false,    {}};
  field.keys = SetupKeys;
  field.schema = [workpiece = workpiece->schema] {
    const Value whole = workpiece();
    Value properties = Value::Map();
    properties.Put("name", WordSchema());
    for (const std::string& key : kPlaceKeys) properties.Put(key, *whole.Find("properties")->Find(key));
    return NamedMapsSchema(properties, kMostSetups);
  };
  field.read = [](const Value& value, const Context& context, JobSettings&) {
    context.Add(value.mark, "has no effect without operations");
  };
  field.write = [](const JobSettings&) { return Value(); };
  return field;
}

void CheckSetups(const Value& root, const std::vector<std::string>& names, const Context& context) {
  const Value& operations = *root.Find("operations");
  const Value* setups = root.Find("setups");
  if (!setups) {
    for (size_t i = 0; i < operations.items.size(); ++i)
      if (const Value::Key* key = operations.items[i].FindKey("setup"))
        context.Child("operations")
            .Child(i)
            .Child("setup")
            .Add(key->mark, "has no effect here: the job has no setups");
    return;
  }
  const Context at = context.Child("setups");
  if (setups->kind != Value::Kind::kList || setups->items.empty() || setups->items.size() > kMostSetups) {
    at.AddWrong(*setups, fmt::format("a list of 1 to {} setups", kMostSetups));
    return;
  }
  const auto known = ReadSetups(*setups, names, at);
  if (const Value* workpiece = root.Find("workpiece"); workpiece && workpiece->kind == Value::Kind::kMap)
    for (const char* key : {"pose", "targets", "registered"})
      if (const Value::Key* given = workpiece->FindKey(key))
        context.Child("workpiece").Child(key).Add(given->mark, "has no effect here: every setup has its own");
  if (known.size() == setups->items.size()) OperationsOfSetups(known, context).Check(operations);
}

std::string SetupOf(const Value& root, size_t number) {
  const Value* setup =
      root.Find("setups") ? ScalarAt(root.Find("operations")->items[number], "setup") : nullptr;
  return setup ? setup->text : std::string();
}

void PlaceInSetup(const Value& root, size_t number, Value& own) {
  const Value* setup = root.Find("setups") ? SetupNamed(root, SetupOf(root, number)) : nullptr;
  Value* workpiece = own.Find("workpiece");
  if (!setup || !workpiece || workpiece->kind != Value::Kind::kMap) return;
  for (size_t i = 0; i < setup->keys.size(); ++i) {
    if (setup->keys[i].text == "name") continue;
    if (Value* given = workpiece->Find(setup->keys[i].text)) {
      *given = setup->items[i];
    } else {
      workpiece->keys.push_back(setup->keys[i]);
      workpiece->items.push_back(setup->items[i]);
    }
  }
}

}  // namespace millpose::config
