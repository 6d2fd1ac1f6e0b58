// SPDX-License-Identifier: GPL-3.0-or-later
// The committed schemas and the reference page are what the field tables say. After a change of the tables:
//   millpose schema job > docs/schema/job.schema.json        (likewise cell; reference >
//   docs/yaml-reference.md)
#include <filesystem>

#include "base/file.hpp"
#include "config/batch_settings.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

std::string Committed(const std::string& file) {
  return ReadFile(std::filesystem::path(SourceDir()) / "docs" / file);
}

}  // namespace

TEST(Generated, JobSchemaIsUpToDate) { EXPECT_EQ(Committed("schema/job.schema.json"), JobSchema()); }

TEST(Generated, CellSchemaIsUpToDate) { EXPECT_EQ(Committed("schema/cell.schema.json"), CellSchema()); }

TEST(Generated, BatchSchemaIsUpToDate) { EXPECT_EQ(Committed("schema/batch.schema.json"), BatchSchema()); }

TEST(Generated, ReferencePageIsUpToDate) { EXPECT_EQ(Committed("yaml-reference.md"), YamlReference()); }

}  // namespace millpose
