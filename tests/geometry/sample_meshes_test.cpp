// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/file.hpp"
#include "geometry/import/mesh_import.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

ImportResult Sample(const std::string& name) {
  const std::string path = fmt::format("{}/toolpaths/{}/{}.stl", SourceDir(), name, name);
  return ImportMesh(ReadMesh(ReadFile(path), path), {}, path);
}

TEST(SampleMeshes, AreClosedSolidsThatNeedNoRepair) {
  for (const char* name : {"support_pad", "cabin_panel", "cabin_ring", "cabin_barrel"}) {
    const ImportReport report = Sample(name).report;
    EXPECT_EQ(Findings(report), std::vector<std::string>{}) << name;
    EXPECT_EQ(report.closed_pieces, 1) << name;
  }
}

TEST(SampleMeshes, HaveTheirSizes) {
  const ImportReport panel = Sample("cabin_panel").report;
  EXPECT_NEAR(panel.upper.x() - panel.lower.x(), 600, 1e-4);
  EXPECT_NEAR(panel.upper.z(), 6, 1e-4);
  const ImportReport ring = Sample("cabin_ring").report;
  EXPECT_NEAR(ring.upper.y(), 500, 1e-4);
  EXPECT_NEAR(ring.upper.z(), 0, 1e-9);
  const ImportReport barrel = Sample("cabin_barrel").report;
  EXPECT_NEAR(barrel.upper.x(), 1206, 1e-4);
  EXPECT_NEAR(barrel.upper.z(), 500, 1e-9);
}

}  // namespace
}  // namespace millpose
