// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>

#include "base/error.hpp"
#include "base/file.hpp"
#include "job/config/config.hpp"
#include "tests/base/refusal.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

JobSettings With(const std::vector<std::string>& changes) {
  static const std::string yaml =
      ReadFile(std::filesystem::path(SourceDir()) / "toolpaths/support_pad/job.yaml");
  std::vector<Override> overrides;
  for (const std::string& change : changes) overrides.push_back(ParseOverride(change));
  return ParseJob(yaml, "job.yaml", overrides);
}

std::string ChangeRefusal(const std::string& change) {
  return RefusalOf([&] { With({change}); });
}

}  // namespace

TEST(Override, ReplacesAndAddsKeys) {
  const JobSettings job = With({"toolpath.stepover_mm=4", "interference={swept_resolution_mm: 0.25}",
                                "limits.singularity_min.wrist=0.1", "programs=[krl]", "name=other"});
  EXPECT_EQ(job.toolpath.stepover, 4);
  EXPECT_EQ(job.swept_resolution, 0.25);
  EXPECT_EQ(job.wrist_min, 0.1);
  EXPECT_EQ(job.programs, std::vector<std::string>{"krl"});
  EXPECT_EQ(job.name, "other");
}

TEST(Override, TheLastOneHolds) { EXPECT_EQ(With({"seed=2", "seed=3"}).seed, 3u); }

TEST(Override, WhatIsWrongIsNamedAsInTheFile) {
  EXPECT_EQ(ChangeRefusal("toolpath.stepover=4"),
            "job.yaml: toolpath.stepover: the key lacks its unit; nearest known key: stepover_mm");
  EXPECT_EQ(ChangeRefusal("toolpath.stepover_mm=-4"),
            "job.yaml: toolpath.stepover_mm: given -4; allowed: number 0.001…10000, mm");
  EXPECT_TRUE(ChangeRefusal("name.first=4")
                  .starts_with("job.yaml: name: given a map; allowed: name that a file can have"));
  EXPECT_TRUE(ChangeRefusal("seed=[").starts_with("--set seed:"));
  for (const char* text : {"seed", "=4", "seed="})
    EXPECT_TRUE(ChangeRefusal(text).starts_with("--set: given ")) << text;
}

}  // namespace millpose
