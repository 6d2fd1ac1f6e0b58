// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/config/config.hpp"

#include "job/config/operations.hpp"
#include "job/config/setup_names.hpp"
#include "job/config/setups.hpp"

namespace millpose {
namespace {

// The entry of a list that has this name, such as an operation.
config::Value& Named(config::Value& list, const std::string& name, const Override& change) {
  std::vector<std::string> names;
  for (config::Value& item : list.items) {
    const config::Value* own = item.Find("name");
    if (own == nullptr || own->kind != config::Value::Kind::kScalar) continue;
    if (own->text == name) return item;
    names.push_back(own->text);
  }
  throw InputError(change.place,
                   fmt::format("--set {}: no entry is called {}; {}", change.path, name,
                               names.empty() ? "none has a name: a list is given as a whole"
                                             : fmt::format("allowed: {}", fmt::join(names, ", "))));
}

// Puts the value at its place, making the maps on the way that are missing; entries of lists go by their
// name.
void Apply(const Override& change, config::Value* root) {
  config::Value* place = root;
  for (size_t begin = 0; begin <= change.path.size();) {
    const size_t end = std::min(change.path.find('.', begin), change.path.size());
    const std::string key = change.path.substr(begin, end - begin);
    begin = end + 1;
    if (place->kind == config::Value::Kind::kList) {
      place = &Named(*place, key, change);
      continue;
    }
    if (place->kind != config::Value::Kind::kMap) *place = config::Value::Map();
    if (!place->Find(key)) place->Put(key, {});
    place = place->Find(key);
  }
  // A list around it makes any text a document.
  *place = config::ReadYaml("[" + change.value + "]", "--set " + change.path).items.at(0);
  place->mark = {};
}

// A file of another kind is reported as such, not key by key. Its version key says the kind.
void RefuseOtherKind(const config::Value& root, const std::string& name, const std::string& own_key) {
  static const std::map<std::string, std::string> kKinds{{"millpose_job", "job"},
                                                         {"millpose_cell", "cell"},
                                                         {"millpose_batch", "batch"},
                                                         {"millpose_tools", "tools"}};
  if (root.FindKey(own_key) != nullptr) return;
  for (const auto& [key, kind] : kKinds)
    if (const config::Value::Key* given = root.FindKey(key))
      throw InputError(
          {name, given->mark.line, given->mark.column},
          fmt::format("this is a {} file; a {} file is expected here", kind, kKinds.at(own_key)));
}

// The tree of a file that is one of the kind that `own_key` says.
config::Value ReadRoot(const std::string& own_key, std::string_view yaml, const std::string& name,
                       const std::vector<Override>& overrides = {}) {
  config::Value root = config::ReadYaml(yaml, name);
  RefuseOtherKind(root, name, own_key);
  for (const Override& change : overrides) Apply(change, &root);
  return root;
}

[[noreturn]] void ThrowInOrder(std::vector<Problem> problems) {
  const auto place = [](const Problem& problem) {
    return std::pair(problem.place.line, problem.place.column);
  };
  std::ranges::stable_sort(problems, {}, place);
  throw InputError(std::move(problems));
}

template <class S>
S Settings(const config::Codec<S>& fields, const config::Value& root, const std::string& name,
           std::vector<Problem>& problems) {
  S settings;
  if constexpr (requires { settings.file; }) settings.file = name;
  fields.read(root, {name, problems, ""}, settings);
  return settings;
}

template <class S>
S Parse(const config::Codec<S>& fields, const std::string& own_key, std::string_view yaml,
        const std::string& name) {
  std::vector<Problem> problems;
  S settings = Settings(fields, ReadRoot(own_key, yaml, name), name, problems);
  if (!problems.empty()) ThrowInOrder(std::move(problems));
  return settings;
}

config::Value JobRoot(std::string_view yaml, const std::string& name,
                      const std::vector<Override>& overrides) {
  return ReadRoot("millpose_job", yaml, name, overrides);
}

std::vector<std::string> NamesOf(const config::Value& root, const std::string& name) {
  if (!root.Find("operations")) return {};
  std::vector<Problem> problems;
  std::vector<std::string> names = config::OperationNames(root, {name, problems, ""});
  // As given: its operations' names are made from it.
  if (const config::Value* own = root.Find("name")) {
    std::string ignored;
    config::FileName().read(*own, config::Context{name, problems, ""}.Child("name"), ignored);
  }
  if (!problems.empty()) ThrowInOrder(std::move(problems));
  return names;
}

// What the job's own sections have wrong is reported once, not with every operation.
void AddNew(const std::vector<Problem>& more, std::vector<Problem>& problems) {
  for (const Problem& problem : more)
    if (std::ranges::none_of(problems, [&](const Problem& known) {
          return known.message == problem.message && known.place.line == problem.place.line;
        }))
      problems.push_back(problem);
}

JobSettings OneOf(const config::Value& root, const std::string& name, size_t operations, size_t chosen) {
  std::vector<Problem> problems;
  JobSettings job;
  double later = 0;  // mm: what this operation and later ones take off
  for (size_t i = 0; i < operations; ++i) {
    std::vector<Problem> own;
    JobSettings settings = Settings(config::JobFields(), config::OperationRoot(root, i), name, own);
    AddNew(own, problems);
    if (i == chosen) job = settings;
    if (i >= chosen) later = std::max(later, settings.toolpath.layers.total);
  }
  if (!problems.empty()) ThrowInOrder(std::move(problems));
  // What nobody has milled yet stands on the part.
  if (!job.workpiece.allowance && later > job.toolpath.layers.total) job.workpiece.allowance = later;
  return job;
}

std::string Schema(const config::Value& fields_schema, const std::string& title) {
  using config::Value;
  Value schema = Value::Map();
  schema.Put("$schema", Value::Text("https://json-schema.org/draft/2020-12/schema"));
  schema.Put("title", Value::Text(title));
  for (size_t i = 0; i < fields_schema.keys.size(); ++i)
    schema.Put(fields_schema.keys[i].text, fields_schema.items[i]);
  return config::WriteJson(schema);
}

}  // namespace

JobSettings ParseJob(std::string_view yaml, const std::string& name, const std::vector<Override>& overrides,
                     std::optional<size_t> operation) {
  const config::Value root = JobRoot(yaml, name, overrides);
  if (const std::vector<std::string> names = NamesOf(root, name); !names.empty()) {
    if (operation) return OneOf(root, name, names.size(), *operation);
    const config::Value::Key& key = *root.FindKey("operations");
    throw InputError(
        {name, key.mark.line, key.mark.column},
        fmt::format("operations: given {}; one at a time allowed here: the job.yaml of its folder in the "
                    "output folder of millpose plan",
                    names.size()));
  }
  std::vector<Problem> problems;
  JobSettings job = Settings(config::JobFields(), root, name, problems);
  if (!problems.empty()) ThrowInOrder(std::move(problems));
  return job;
}

JobOutline OutlineOf(std::string_view yaml, const std::string& name, const std::vector<Override>& overrides) {
  const config::Value root = JobRoot(yaml, name, overrides);
  const config::Value* own = root.Find("name");
  return {own ? own->text : std::string(), NamesOf(root, name)};
}

std::vector<std::string> SetupNames(std::string_view yaml, const std::string& name,
                                    const std::vector<Override>& overrides) {
  const config::Value root = JobRoot(yaml, name, overrides);
  std::vector<std::string> setups;
  for (size_t i = 0; i < NamesOf(root, name).size(); ++i) setups.push_back(config::SetupOf(root, i));
  return setups;
}

std::string WithOverrides(std::string_view yaml, const std::string& name,
                          const std::vector<Override>& overrides) {
  return config::WriteYaml(JobRoot(yaml, name, overrides));
}

Override ParseOverride(const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw InputError(SourceLocation{},
                     fmt::format("--set: given {}; allowed: KEY=VALUE like toolpath.stepover_mm=4", text));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

CellSettings ParseCell(std::string_view yaml, const std::string& name) {
  return Parse(config::CellFields(), "millpose_cell", yaml, name);
}

ToolsFile ParseTools(std::string_view yaml, const std::string& name) {
  return Parse(config::ToolsFileFields(), "millpose_tools", yaml, name);
}

BatchSettings ParseBatch(std::string_view yaml, const std::string& name) {
  return Parse(config::BatchFields(), "millpose_batch", yaml, name);
}

std::string WriteJob(const JobSettings& job) { return config::WriteYaml(config::JobFields().write(job)); }

std::string WriteCell(const CellSettings& cell) {
  return config::WriteYaml(config::CellFields().write(cell));
}

std::string JobSchema() { return Schema(config::JobFields().schema(), "millpose job"); }

std::string BatchSchema() { return Schema(config::BatchFields().schema(), "millpose batch"); }

std::string ToolsSchema() { return Schema(config::ToolsFileFields().schema(), "millpose tools"); }

std::string CellSchema() { return Schema(config::CellFields().schema(), "millpose cell"); }

}  // namespace millpose
