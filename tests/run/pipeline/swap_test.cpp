// SPDX-License-Identifier: GPL-3.0-or-later
// From one plan's results to the next one's: whatever was done when a run ended, one whole set is there
// afterwards.
#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "store/folder_lock.hpp"
#include "store/manifest.hpp"
#include "store/output_folder.hpp"
#include "store/result_swap.hpp"
#include "tests/base/refusal.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

namespace fs = std::filesystem;

using Files = std::map<std::string, std::string>;

/// All files below a folder with what they hold.
Files FilesIn(const fs::path& folder) {
  Files files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[entry.path().lexically_relative(folder).string()] = ReadFile(entry.path());
  return files;
}

void Put(const fs::path& folder, const Files& files) {
  for (const auto& [name, text] : files) {
    fs::create_directories((folder / name).parent_path());
    WriteFileAtomically(folder / name, text);
  }
}

const Files kOld{{"job.yaml", "old job"},
                 {"deflection.csv", "old"},
                 {"manifest.json", R"({"schema_version": 1, "key": "old", "files": [
                     {"path": "job.yaml", "bytes": 7, "hash": ""}, {"path": "deflection.csv", "bytes": 3, "hash": ""},
                     {"path": "programs/krl/a.src", "bytes": 5, "hash": ""}]})"},
                 {"programs/krl/a.src", "old a"},
                 {"programs/krl/b.src", "old b"}};
const Files kNew{{"job.yaml", "new job"},
                 {"report.html", "new"},
                 {"manifest.json", R"({"schema_version": 1, "key": "new", "files": [
                     {"path": "job.yaml", "bytes": 7, "hash": ""}, {"path": "report.html", "bytes": 3, "hash": ""},
                     {"path": "programs/krl/a.src", "bytes": 5, "hash": ""}]})"},
                 {"programs/krl/a.src", "new a"}};
const Files kOwn{{"note.txt", "the user's"}};
const std::vector<std::string> kOldNames{"deflection.csv", "job.yaml", "manifest.json", "programs"},
    kNewNames{"job.yaml", "manifest.json", "programs", "report.html"};

Files With(Files files) {
  files.insert(kOwn.begin(), kOwn.end());
  return files;
}

/// The renames of a swap in their order: the old set away, manifest and programs first; the new one in, these
/// last.
std::vector<std::pair<std::string, std::string>> Renames() {
  std::vector<std::pair<std::string, std::string>> renames;
  for (const char* name : {"manifest.json", "programs", "deflection.csv", "job.yaml"})
    renames.emplace_back(name, std::string(".replaced/") + name);
  for (const char* name : {"report.html", "job.yaml", "programs", "manifest.json"})
    renames.emplace_back(std::string(".staging/") + name, name);
  return renames;
}

/// A folder in which a swap was ended after so many renames.
void BeginSwap(const fs::path& folder, size_t renames) {
  Put(folder, With(kOld));
  Put(folder / ".staging", kNew);
  Put(folder, {{".journal", nlohmann::json{{"new", kNewNames}, {"old", kOldNames}}.dump()}});
  fs::create_directories(folder / ".replaced");
  for (size_t i = 0; i < renames; ++i) fs::rename(folder / Renames()[i].first, folder / Renames()[i].second);
}

TEST(SwapResults, TheNewSetTakesThePlaceOfTheOld) {
  const TestFolder folder("swap");
  Put(folder.path(), With(kOld));
  Put(folder.path() / kStagingFolder, kNew);
  SwapResults(Folder(folder.path()), kOldNames);
  EXPECT_EQ(FilesIn(folder.path()), With(kNew));
  EXPECT_FALSE(IsSwapOpen(Folder(folder.path())));
}

TEST(RecoverResults, FinishesASwapWhereverItWasEnded) {
  for (size_t renames = 0; renames <= Renames().size(); ++renames) {
    const TestFolder folder("swap");
    BeginSwap(folder.path(), renames);
    EXPECT_TRUE(IsSwapOpen(Folder(folder.path())));
    RecoverResults(Folder(folder.path()));
    EXPECT_EQ(FilesIn(folder.path()), With(kNew)) << renames;
    RecoverResults(Folder(folder.path()));
    EXPECT_EQ(FilesIn(folder.path()), With(kNew)) << renames << ", once more";
  }
}

// A file of the new set is gone: what was there before comes back as a whole.
TEST(RecoverResults, TakesASwapBackThatCannotBeFinished) {
  for (size_t renames = 0; renames <= 4; ++renames) {
    const TestFolder folder("swap");
    BeginSwap(folder.path(), renames);
    fs::remove_all(folder.path() / ".staging" / "programs");
    RecoverResults(Folder(folder.path()));
    EXPECT_EQ(FilesIn(folder.path()), With(kOld)) << renames;
  }
}

TEST(RecoverResults, WhatNeverBeganIsRemoved) {
  const TestFolder folder("swap");
  Put(folder.path(), With(kOld));
  Put(folder.path() / kStagingFolder, kNew);
  EXPECT_EQ(RecoverResults(Folder(folder.path())), "");
  EXPECT_EQ(FilesIn(folder.path()), With(kOld));
}

const char* const kDamagedJournals[] = {"",
                                        "{",
                                        "[]",
                                        R"({"new": 1})",
                                        R"({"new": [], "old": [1]})",
                                        R"({"new":[],"old":["../outside/victim.txt"]})",
                                        R"({"new":[],"old":["/etc/passwd"]})",
                                        R"({"new":[""],"old":["."]})",
                                        R"({"new":[],"old":["programs/krl"]})",
                                        R"({"new":[],"old":[".lock"]})",
                                        R"({"new":["checkpoints"],"old":[".millpose"]})"};

// A journal says nothing that the folder does not: where it is damaged, both manifests say it.
TEST(RecoverResults, FinishesWithADamagedJournalToo) {
  for (const char* journal : kDamagedJournals)
    for (size_t renames = 0; renames <= Renames().size(); ++renames) {
      const TestFolder folder("swap");
      BeginSwap(folder.path(), renames);
      Put(folder.path(), {{".journal", journal}});
      EXPECT_NE(RecoverResults(Folder(folder.path())).find(".journal: "), std::string::npos);
      EXPECT_EQ(FilesIn(folder.path()), With(renames == 0 ? kOld : kNew)) << renames << ", " << journal;
    }
}

TEST(RecoverResults, WithoutAnythingThatTellsGivesBackWhatWasTaken) {
  for (size_t renames = 1; renames <= kOldNames.size(); ++renames) {
    const TestFolder folder("swap");
    BeginSwap(folder.path(), renames);
    for (const char* name : {".journal", ".staging/manifest.json", ".replaced/manifest.json"})
      Put(folder.path(), {{name, "damaged"}});
    RecoverResults(Folder(folder.path()));
    Files expected = With(kOld);
    expected[kManifestFile] = "damaged";
    EXPECT_EQ(FilesIn(folder.path()), expected) << renames;
  }
}

TEST(RecoverResults, ALinkOrAPipeInPlaceOfAnythingIsNoWayOut) {
  for (const char* name : {".journal", ".staging", ".replaced"}) {
    const TestFolder home("swap");
    const fs::path folder = home.path() / "own", outside = home.path() / "outside";
    Put(outside, {{"victim", "theirs"}, {"programs/a.src", "theirs"}});
    for (const bool pipe : {false, true}) {
      fs::remove_all(folder);
      Put(folder, With(kOld));
      Put(folder, {{".journal", R"({"new":["victim","programs"],"old":["job.yaml"]})"}});
      fs::remove_all(folder / name);
      if (pipe)
        ASSERT_EQ(::mkfifo((folder / name).c_str(), 0600), 0);
      else
        fs::create_symlink(outside, folder / name);
      RecoverResults(Folder(folder));
      EXPECT_EQ(FilesIn(outside), (Files{{"victim", "theirs"}, {"programs/a.src", "theirs"}})) << name;
      EXPECT_FALSE(fs::exists(folder / "victim")) << name;
      EXPECT_EQ(ReadFile(folder / "job.yaml"), "old job") << name;
      for (const char* gone : {".journal", ".staging", ".replaced"})
        EXPECT_FALSE(fs::is_symlink(fs::symlink_status(folder / gone))) << gone;
    }
  }
}

TEST(SwapResults, NamesOfTheSwapAreNoneOfASet) {
  for (const char* name : {".staging", ".replaced", ".journal", ".lock", ".millpose", "checkpoints",
                           ".owner.a.1", "", ".", "..", "a/b", "/a"})
    EXPECT_FALSE(IsOfSet(name)) << name;
  for (const char* name : {"staging", "programs", "manifest.json"}) EXPECT_TRUE(IsOfSet(name)) << name;
  EXPECT_TRUE(IsOfSet(std::string(255, 'x')));
  EXPECT_FALSE(IsOfSet(std::string(256, 'x')));  // no file system could even look for it
}

TEST(FolderLock, NamesWhoHasTheFolder) {
  const TestFolder folder("folder_lock");
  const FolderLock own(folder.path(), FileLock::Kind::kExclusive);
  EXPECT_EQ(own.warning(), "");
  const std::string refusal = RefusalOf([&] { FolderLock(folder.path(), FileLock::Kind::kShared); });
  EXPECT_NE(refusal.find(fmt::format("another run works in this folder: process {} on ", ::getpid())),
            std::string::npos)
      << refusal;
  EXPECT_NE(refusal.find("; wait for its end or choose another with -o DIR"), std::string::npos);
}

TEST(FolderLock, ManyAddCheckpointsAtOnceAndLeaveNothingBehind) {
  const TestFolder folder("folder_lock");
  {
    const FolderLock first(folder.path(), FileLock::Kind::kShared),
        second(folder.path(), FileLock::Kind::kShared);
    for (const auto& [name, text] : FilesIn(folder.path())) EXPECT_TRUE(IsOfLock(name)) << name;
  }
  const FolderLock alone(folder.path(), FileLock::Kind::kExclusive);
  EXPECT_EQ(FilesIn(folder.path()).size(), 2u) << "the lock, and who has it";
}

TEST(FolderLock, OneWhoIsAloneTidiesUpAfterThoseThatWereKilled) {
  const TestFolder folder("folder_lock");
  folder.Write(".owner.somewhere.4711",
               R"({"host": "somewhere", "process": 4711, "since": "2026-01-01T00:00:00Z", "alone": true})");
  folder.Write(".owner.damaged.1", "{");
  const FolderLock alone(folder.path(), FileLock::Kind::kExclusive);
  EXPECT_FALSE(fs::exists(folder.path() / ".owner.somewhere.4711"));
  EXPECT_FALSE(fs::exists(folder.path() / ".owner.damaged.1"));
}

TEST(OutputFolder, OfSeveralOperationsIsNamedAsSuch) {
  const TestFolder folder("several");
  { const OutputFolder mark(folder.path() / "out", FolderUse::kResults); }
  const fs::path out = folder.path() / "out";
  EXPECT_TRUE(IsOutputFolder(out));
  EXPECT_FALSE(HoldsSeveral(out));
  EXPECT_NO_THROW(RefuseSeveral(out));
  fs::create_directories(out / kOperationsFolder / "01_face");
  fs::create_directories(out / kOperationsFolder / "02_trim");
  for (const char* name : {"01_face", "02_trim"})
    const OutputFolder mark(out / kOperationsFolder / name, FolderUse::kResults);
  EXPECT_TRUE(HoldsSeveral(out));
  const std::string refusal = RefusalOf([&] { RefuseSeveral(out); });
  EXPECT_NE(refusal.find("01_face"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("02_trim"), std::string::npos) << refusal;
}

TEST(Manifest, WhatIsNoManifestIsRefused) {
  for (const char* text : {"", "{", "[]", "{}", R"({"schema_version": 1, "key": 3, "files": []})",
                           R"({"schema_version": 1, "key": "", "files": [{"path": "a", "bytes": -1}]})"})
    EXPECT_NE(RefusalOf([&] { ParseManifest(text, "m.json"); }).find("m.json: is no manifest of millpose"),
              std::string::npos)
        << text;
  EXPECT_EQ(RefusalOf([] { ParseManifest(R"({"schema_version": 2, "key": "", "files": []})", "m.json"); }),
            "m.json: is of another version of millpose");
  Manifest manifest;
  manifest.key = "k";
  manifest.files = {{"a", {1, "h"}}, {"b/c \"d\" ä", {20000000000, ""}}};
  EXPECT_EQ(ManifestJson(ParseManifest(ManifestJson(manifest), "m")), ManifestJson(manifest));
}

}  // namespace
}  // namespace millpose::test
