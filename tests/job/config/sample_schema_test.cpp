// SPDX-License-Identifier: GPL-3.0-or-later
// Editors check jobs and cells by the published schemas: what the project ships must pass them.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/yaml/value.hpp"
#include "job/config/config.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;
using SchemaJson = nlohmann::json;

// What a reader of YAML 1.2 makes of a tree.
SchemaJson AsJson(const yaml::Value& value) {
  switch (value.kind) {
    case yaml::Value::Kind::kNull:
      return nullptr;
    case yaml::Value::Kind::kScalar:
      if (!value.plain) return value.text;
      if (value.text == "true" || value.text == "false") return value.text == "true";
      if (const auto number = ParseNumber(value.text)) {
        if (*number == std::floor(*number) && std::abs(*number) < 1e15) return static_cast<int64_t>(*number);
        return *number;
      }
      return value.text;
    case yaml::Value::Kind::kList: {
      SchemaJson list = SchemaJson::array();
      for (const yaml::Value& item : value.items) list.push_back(AsJson(item));
      return list;
    }
    case yaml::Value::Kind::kMap: {
      SchemaJson map = SchemaJson::object();
      for (size_t i = 0; i < value.keys.size(); ++i) map[value.keys[i].text] = AsJson(value.items[i]);
      return map;
    }
  }
  return nullptr;
}

bool IsOfType(const SchemaJson& value, const std::string& type) {
  return (type == "object" && value.is_object()) || (type == "array" && value.is_array()) ||
         (type == "string" && value.is_string()) || (type == "boolean" && value.is_boolean()) ||
         (type == "null" && value.is_null()) || (type == "number" && value.is_number()) ||
         (type == "integer" && value.is_number_integer());
}

// The keywords that the schemas use. Any other is a failure: nobody would see what it forbids.
class SchemaJudge {
 public:
  std::vector<std::string> problems;

  bool Holds(const SchemaJson& value, const SchemaJson& schema) {
    SchemaJudge judge;
    judge.Check(value, schema, "");
    return judge.problems.empty();
  }

  void Check(const SchemaJson& value, const SchemaJson& schema, const std::string& path) {
    for (const auto& [keyword, rule] : schema.items()) CheckOne(value, keyword, rule, schema, path);
  }

 private:
  void Add(const std::string& path, const std::string& text) { problems.push_back(path + ": " + text); }

  void CheckOne(const SchemaJson& value, const std::string& keyword, const SchemaJson& rule,
                const SchemaJson& schema, const std::string& path) {
    if (keyword == "$schema" || keyword == "title" || keyword == "description" || keyword == "default")
      return;
    const auto all_of_list = [&](auto holds) { return std::ranges::all_of(rule, holds); };
    const auto any_of_list = [&](auto holds) { return std::ranges::any_of(rule, holds); };
    const auto holds = [&](const SchemaJson& one) { return Holds(value, one); };
    bool good = true;
    if (keyword == "type") {
      good = rule.is_string() ? IsOfType(value, rule)
                              : any_of_list([&](const SchemaJson& type) { return IsOfType(value, type); });
    } else if (keyword == "enum") {
      good = std::ranges::find(rule, value) != rule.end();
    } else if (keyword == "const") {
      good = value == rule;
    } else if (keyword == "anyOf") {
      good = any_of_list(holds);
    } else if (keyword == "oneOf") {
      good = std::ranges::count_if(rule, holds) == 1;
    } else if (keyword == "allOf") {
      good = all_of_list(holds);
    } else if (keyword == "required") {
      good = !value.is_object() ||
             all_of_list([&](const SchemaJson& key) { return value.contains(key.get<std::string>()); });
    } else if (keyword == "properties" || keyword == "additionalProperties") {
      return CheckProperties(value, keyword, schema, path);
    } else if (keyword == "items") {
      for (size_t i = 0; value.is_array() && i < value.size(); ++i)
        Check(value[i], rule, fmt::format("{}[{}]", path, i));
    } else if (keyword == "minItems" || keyword == "maxItems") {
      good = !value.is_array() || (keyword == "minItems" ? value.size() >= rule : value.size() <= rule);
    } else if (keyword == "minProperties" || keyword == "maxProperties") {
      good = !value.is_object() || (keyword == "minProperties" ? value.size() >= rule : value.size() <= rule);
    } else if (keyword == "minLength" || keyword == "maxLength") {
      good = !value.is_string() || (keyword == "minLength" ? value.get<std::string>().size() >= rule
                                                           : value.get<std::string>().size() <= rule);
    } else if (keyword == "pattern") {
      good = !value.is_string() ||
             std::regex_search(value.get<std::string>(), std::regex(rule.get<std::string>()));
    } else if (keyword == "minimum") {
      good = !value.is_number() || value >= rule;
    } else if (keyword == "maximum") {
      good = !value.is_number() || value <= rule;
    } else if (keyword == "exclusiveMinimum") {
      good = !value.is_number() || value > rule;
    } else {
      return Add(path, "no such keyword is known here: " + keyword);
    }
    if (!good) Add(path, fmt::format("{} breaks {}: {}", value.dump(), keyword, rule.dump()));
  }

  void CheckProperties(const SchemaJson& value, const std::string& keyword, const SchemaJson& schema,
                       const std::string& path) {
    if (!value.is_object()) return;
    const SchemaJson none = SchemaJson::object();
    const SchemaJson& properties = schema.contains("properties") ? schema["properties"] : none;
    for (const auto& [key, item] : value.items()) {
      const bool known = properties.contains(key);
      if (keyword == "properties") {
        if (known) Check(item, properties[key], path + '.' + key);
      } else if (!known) {
        const SchemaJson& others = schema["additionalProperties"];
        if (others == false) Add(path, "no key " + key);
        if (others.is_object()) Check(item, others, path + '.' + key);
      }
    }
  }
};

std::vector<std::string> ProblemsOf(const std::string& text, const std::string& schema) {
  SchemaJudge judge;
  judge.Check(AsJson(yaml::ReadYaml(text, "f.yaml")), SchemaJson::parse(schema), "");
  return judge.problems;
}

std::vector<fs::path> Shipped(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(SourceDir()) / folder))
    if (entry.path().extension() == ".yaml" && entry.path().string().find(".out/") == std::string::npos)
      files.push_back(entry.path());  // not what a plan beside a job wrote
  return files;
}

}  // namespace

TEST(SampleSchema, EveryShippedJobPassesThePublishedSchema) {
  const std::vector<fs::path> files = Shipped("toolpaths");
  EXPECT_GE(files.size(), 12u);
  for (const fs::path& file : files)
    EXPECT_EQ(ProblemsOf(ReadFile(file), JobSchema()), std::vector<std::string>{}) << file;
}

TEST(SampleSchema, EveryShippedCellPassesThePublishedSchema) {
  const std::vector<fs::path> files = Shipped("cells");
  EXPECT_GE(files.size(), 10u);
  for (const fs::path& file : files)
    EXPECT_EQ(ProblemsOf(ReadFile(file), CellSchema()), std::vector<std::string>{}) << file;
}

TEST(SampleSchema, WhatAJobLacksTheSchemaTells) {
  const std::string job = ReadFile(fs::path(SourceDir()) / "toolpaths/support_pad/job.yaml");
  ASSERT_EQ(ProblemsOf(job, JobSchema()), std::vector<std::string>{});
  const auto without = [&](const std::string& key) {
    const size_t at = job.find("\n  " + key);
    EXPECT_NE(at, std::string::npos) << key;
    return job.substr(0, at) + job.substr(job.find('\n', at + 1));
  };
  for (const char* key : {"feed_mm_min", "spindle_rpm", "strategy", "unit"})
    EXPECT_NE(ProblemsOf(without(key), JobSchema()), std::vector<std::string>{}) << key;
  std::string unknown = job;
  EXPECT_NE(ProblemsOf(unknown + "nosuch: 1\n", JobSchema()), std::vector<std::string>{});
}

}  // namespace millpose
