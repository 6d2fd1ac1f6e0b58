// SPDX-License-Identifier: GPL-3.0-or-later
// Two jobs of a batch whose programs would take each other's place on a controller.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "base/error.hpp"
#include "base/file.hpp"
#include "run/batch/batch.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {
namespace fs = std::filesystem;

/// Jobs of these names in one folder; what a batch of them is told, empty: nothing.
std::string Told(const std::vector<std::string>& names, const std::string& programs = "[krl]",
                 const char* sample = "support_pad") {
  const fs::path folder = fs::path(testing::TempDir()) / fmt::format("batch_names.{}", ::getpid());
  fs::create_directories(folder);
  const std::string text = ReadFile(fs::path(SourceDir()) / "toolpaths" / sample / "job.yaml");
  std::vector<std::string> files;
  for (size_t i = 0; i < names.size(); ++i) {
    std::string job = text;
    const size_t name = job.find("\nname: ") + 1, end = job.find('\n', name);
    job.replace(name, end - name, "name: '" + names[i] + "'");
    if (const size_t at = job.find("\nprograms:"); at != std::string::npos)
      job.erase(at + 1, job.find('\n', at + 1) - at);
    job += "programs: " + programs + "\n";
    files.push_back((folder / fmt::format("{}.yaml", i)).string());
    WriteFileAtomically(files.back(), job);
  }
  std::string told;
  try {
    EXPECT_EQ(CollectJobs(files, {}).size(), names.size());
  } catch (const InputError& error) {
    told = error.what();
  }
  fs::remove_all(folder);
  return told;
}

TEST(BatchNames, ACommonBeginningOf24CharactersIsNoMatter) {
  EXPECT_EQ(Told({"fuselage_section_47_keel_beam_finish", "fuselage_section_47_keel_beam_rough"}), "");
  EXPECT_EQ(Told({"fuselage_section_47_keel_beam_finish", "fuselage_section_47_keel_beam_rough"},
                 "[krl, linuxcnc]", "cabin_window"),
            "");
}

TEST(BatchNames, WhatControllersDoNotTellApartIsRefused) {
  for (const auto& [one, other] : {std::pair{"panel-1", "panel_1"},
                                   {"Panel", "panel"},
                                   {"panel 1", "panel.1"},
                                   {"panel", "panel_001"},
                                   {"panel_P0_1", "panel"}}) {
    const std::string told = Told({one, other});
    EXPECT_NE(told.find("are both called krl/"), std::string::npos) << one << ", " << other << ": " << told;
    EXPECT_NE(told.find(".yaml: name: programs of "), std::string::npos) << told;
  }
  EXPECT_EQ(Told({"panel", "panel_2"}), "");
  EXPECT_EQ(Told({"panel-1", "panel_1"}, "[]"), "");  // neither has a program
}

}  // namespace
}  // namespace millpose
