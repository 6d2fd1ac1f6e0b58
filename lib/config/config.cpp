// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/config.hpp"

#include "config/fields.hpp"

namespace millpose {
namespace {

template <class S>
S Parse(const config::Codec<S>& fields, std::string_view yaml, const std::string& name) {
  const config::Value root = config::ReadYaml(yaml, name);
  std::vector<Problem> problems;
  S settings;
  settings.file = name;
  fields.read(root, {name, problems, ""}, settings);
  if (problems.empty()) return settings;
  std::ranges::stable_sort(problems, {}, [](const Problem& problem) {
    return std::pair(problem.place.line, problem.place.column);
  });
  throw InputError(std::move(problems));
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

JobSettings ParseJob(std::string_view yaml, const std::string& name) {
  return Parse(config::JobFields(), yaml, name);
}

CellSettings ParseCell(std::string_view yaml, const std::string& name) {
  return Parse(config::CellFields(), yaml, name);
}

std::string WriteJob(const JobSettings& job) { return config::WriteYaml(config::JobFields().write(job)); }

std::string WriteCell(const CellSettings& cell) {
  return config::WriteYaml(config::CellFields().write(cell));
}

std::string JobSchema() { return Schema(config::JobFields().schema, "millpose job"); }

std::string CellSchema() { return Schema(config::CellFields().schema, "millpose cell"); }

}  // namespace millpose
