// SPDX-License-Identifier: GPL-3.0-or-later
// The committed schemas and the reference page are what the field tables say. After a change of the tables:
//   millpose schema job > docs/schema/job.schema.json        (likewise cell; reference >
//   docs/yaml-reference.md)
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/millpose/piped_objective.hpp"
#include "base/file.hpp"
#include "job/config/batch_settings.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

std::string Committed(const std::string& file) {
  return ReadFile(std::filesystem::path(SourceDir()) / "docs" / file);
}

// The program's schemas know its own objective too; registries are filled before the first look at them.
[[maybe_unused]] const bool kAdded = (AddPipedObjective(), true);

using Json = nlohmann::json;

// Paths of the numbers in a schema that have no lower or no upper end.
void FindEndless(const Json& schema, const std::string& path, std::vector<std::string>& endless) {
  if (!schema.is_structured()) return;
  if (schema.is_object() && schema.contains("type") &&
      (schema["type"] == "number" || schema["type"] == "integer"))
    if (!schema.contains("enum") &&
        !(schema.contains("maximum") && (schema.contains("minimum") || schema.contains("exclusiveMinimum"))))
      endless.push_back(path);
  for (const auto& [key, value] : schema.items()) FindEndless(value, path + '/' + key, endless);
}

}  // namespace

TEST(Generated, EveryNumberHasTwoEnds) {
  std::vector<std::string> endless;
  for (const std::string& schema : {JobSchema(), CellSchema(), ToolsSchema(), BatchSchema()})
    FindEndless(Json::parse(schema), "", endless);
  EXPECT_EQ(endless, std::vector<std::string>{});
}

TEST(Generated, JobSchemaIsUpToDate) { EXPECT_EQ(Committed("schema/job.schema.json"), JobSchema()); }

TEST(Generated, CellSchemaIsUpToDate) { EXPECT_EQ(Committed("schema/cell.schema.json"), CellSchema()); }

TEST(Generated, ToolsSchemaIsUpToDate) { EXPECT_EQ(Committed("schema/tools.schema.json"), ToolsSchema()); }

TEST(Generated, BatchSchemaIsUpToDate) { EXPECT_EQ(Committed("schema/batch.schema.json"), BatchSchema()); }

TEST(Generated, ReferencePageIsUpToDate) { EXPECT_EQ(Committed("yaml-reference.md"), YamlReference()); }

}  // namespace millpose
