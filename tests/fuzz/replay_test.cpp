// SPDX-License-Identifier: GPL-3.0-or-later
// The seeds of the fuzz targets and every file that once made one fail, through the same entries; and spoilt
// copies of each, so that a reader that lost a check is seen here too.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "base/file.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/fuzz/entries.hpp"
#include "tests/geometry/mutate.hpp"

namespace millpose {
namespace {

std::vector<std::filesystem::path> FilesIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::exists(folder))
    for (const auto& file : std::filesystem::directory_iterator(folder))
      if (file.is_regular_file()) files.push_back(file.path());
  std::ranges::sort(files);
  return files;
}

std::vector<std::string> SeedsOf(const std::string& name) {
  const std::filesystem::path tests = std::filesystem::path(SourceDir()) / "tests";
  std::vector<std::filesystem::path> folders = {tests / "fuzz" / "seeds" / name, tests / "golden" / name};
  if (name == "verify")
    folders.insert(folders.end(),
                   {tests / "golden/krl", tests / "golden/linuxcnc", tests / "golden/sinumerik"});
  std::vector<std::string> seeds;
  for (const auto& folder : folders)
    for (const auto& file : FilesIn(folder)) seeds.push_back(ReadFile(file));
  return seeds;
}

std::vector<FuzzEntry> AllEntries() {
  std::vector<FuzzEntry> entries = YamlEntries();
  for (const auto& more : {MeshEntries(), CamEntries(), ProgramEntries(), VerifyEntries(), StepEntries()})
    entries.insert(entries.end(), more.begin(), more.end());
  return entries;
}

class Replay : public testing::TestWithParam<FuzzEntry> {};

TEST_P(Replay, SeedsAndSpoiltSeedsAreReadOrRefused) {
  const std::vector<std::string> seeds = SeedsOf(GetParam().name);
  ASSERT_GE(seeds.size(), 1u) << "an entry without seeds";
  for (const std::string& seed : seeds) {
    GetParam().run(seed);
    for (int i = 0; i < GetParam().copies; ++i) {
      RandomStream random(static_cast<uint64_t>(i), 37);
      GetParam().run(Mutated(seed, random));
    }
  }
}

TEST(Verify, SomeSeedsComeThroughTheReadersToTheReplay) {
  const int before = ProgramsReplayed();
  for (const std::string& seed : SeedsOf("verify")) VerifyEntries()[0].run(seed);
  EXPECT_GE(ProgramsReplayed() - before, 2);
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Replay, testing::ValuesIn(AllEntries()),
                         [](const auto& entry) { return entry.param.name; });

TEST(Seeds, EveryFolderBelongsToAnEntry) {
  std::set<std::string> names;
  for (const FuzzEntry& entry : AllEntries()) names.insert(entry.name);
  for (const auto& folder :
       std::filesystem::directory_iterator(std::filesystem::path(SourceDir()) / "tests/fuzz/seeds"))
    EXPECT_TRUE(names.contains(folder.path().filename().string())) << folder.path();
}

}  // namespace
}  // namespace millpose
