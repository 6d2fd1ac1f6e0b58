// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/output_folder.hpp"

#include <unistd.h>

#include "base/error.hpp"
#include "base/file.hpp"
#include "output/result_swap.hpp"

namespace millpose {
namespace {
namespace fs = std::filesystem;

class OutputFolderTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(base_); }
  void TearDown() override { fs::remove_all(base_); }

  // A set of these files, each holding its own name and `text`.
  void Publish(const std::vector<std::string>& names, const std::string& text) const {
    const OutputFolder folder(base_ / "out", FolderUse::kResults);
    ResultSet set(folder);
    for (const std::string& name : names) set.Add(name, name + text);
    const std::string manifest = set.AddManifest(text);
    set.Add(kRunFile, fmt::format("{{\"manifest\": \"{}\"}}", manifest));
    set.Publish();
  }

  const fs::path base_ = fs::temp_directory_path() / fmt::format("millpose_output_{}", ::getpid());
};

TEST_F(OutputFolderTest, TakesOnlyWhatIsItsOwn) {
  fs::create_directories(base_ / "theirs");
  WriteFileAtomically(base_ / "theirs" / "thesis.txt", "years of work");
  WriteFileAtomically(base_ / "file", "");
  EXPECT_THROW(OutputFolder(base_ / "theirs", FolderUse::kResults), InputError);
  EXPECT_THROW(OutputFolder(base_ / "file", FolderUse::kResults), InputError);
  EXPECT_EQ(ReadFile(base_ / "theirs" / "thesis.txt"), "years of work");
  EXPECT_NO_THROW(OutputFolder(base_ / "ours", FolderUse::kResults));
  EXPECT_NO_THROW(OutputFolder(base_ / "ours", FolderUse::kResults));
}

TEST_F(OutputFolderTest, OneWritesResultsManyAddCheckpoints) {
  {
    const OutputFolder first(base_ / "out", FolderUse::kCheckpoints);
    const OutputFolder second(base_ / "out", FolderUse::kCheckpoints);
    EXPECT_EQ(first.warning(), "");
    EXPECT_THROW(OutputFolder(base_ / "out", FolderUse::kResults), InputError);
  }
  const OutputFolder writer(base_ / "out", FolderUse::kResults);
  try {
    const OutputFolder second(base_ / "out", FolderUse::kResults);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("another run works in this folder"), std::string::npos);
  }
}

TEST_F(OutputFolderTest, WhatAKilledRunLeftHalfWrittenIsRemoved) {
  OutputFolder(base_ / "out", FolderUse::kResults).WriteCheckpoint("key", "content");
  const fs::path half = base_ / "out" / "checkpoints" / "other.cbor.123.tmp";
  WriteFileAtomically(half, "con");
  EXPECT_EQ(OutputFolder(base_ / "out", FolderUse::kResults).ReadCheckpoint("key"), "content");
  EXPECT_FALSE(fs::exists(half));
}

TEST_F(OutputFolderTest, AFolderWhoseMarkWasNotFinishedIsTaken) {
  std::filesystem::create_directories(base_ / "killed");
  WriteFileAtomically(base_ / "killed" / ".millpose.host.1.tmp", "This fol");
  EXPECT_NO_THROW(OutputFolder(base_ / "killed", FolderUse::kResults));
  EXPECT_TRUE(IsOutputFolder(base_ / "killed"));
}

TEST_F(OutputFolderTest, ASetTakesThePlaceOfTheOneBeforeAndOfNothingElse) {
  Publish({"job.yaml", "deflection.csv", "programs/krl/a.src", "programs/krl/a.dat"}, "1");
  WriteFileAtomically(base_ / "out" / "note.txt", "the user's");
  Publish({"job.yaml", "programs/krl/a.src"}, "2");
  EXPECT_EQ(ReadFile(base_ / "out" / "job.yaml"), "job.yaml2");
  EXPECT_EQ(ReadFile(base_ / "out" / "programs" / "krl" / "a.src"), "programs/krl/a.src2");
  EXPECT_FALSE(fs::exists(base_ / "out" / "programs" / "krl" / "a.dat"));
  EXPECT_FALSE(fs::exists(base_ / "out" / "deflection.csv"));
  EXPECT_EQ(ReadFile(base_ / "out" / "note.txt"), "the user's");
  EXPECT_EQ(CheckManifest(base_ / "out").key, "2");
  EXPECT_FALSE(fs::exists(StagingOf(base_ / "out")));
  Publish({"job.yaml"}, "3");
  EXPECT_FALSE(fs::exists(base_ / "out" / "programs"));
}

TEST_F(OutputFolderTest, WhatIsNotPublishedIsGone) {
  Publish({"job.yaml"}, "1");
  {
    const OutputFolder folder(base_ / "out", FolderUse::kResults);
    ResultSet(folder).Add("job.yaml", "2");
  }
  EXPECT_EQ(ReadFile(base_ / "out" / "job.yaml"), "job.yaml1");
  EXPECT_FALSE(fs::exists(StagingOf(base_ / "out")));
}

TEST_F(OutputFolderTest, AManifestNamesWhatDiffers) {
  Publish({"job.yaml", "points.csv", "programs/krl/a.src"}, "1");
  WriteFileAtomically(base_ / "out" / "job.yaml", "job.yaml2");
  fs::remove(base_ / "out" / "points.csv");
  WriteFileAtomically(base_ / "out" / "programs" / "krl" / "b.src", "");
  WriteFileAtomically(base_ / "out" / kRunFile, "{\"manifest\": \"of another\"}");
  try {
    CheckManifest(base_ / "out");
    FAIL();
  } catch (const InputError& error) {
    ASSERT_EQ(error.problems().size(), 4U);
    for (size_t i = 0; i < 4; ++i)
      EXPECT_TRUE(error.problems()[i].place.file.ends_with(
          std::array{"job.yaml", "points.csv", "b.src", "run.json"}[i]))
          << error.what();
  }
}

TEST_F(OutputFolderTest, AManifestNamesNothingOutsideItsFolder) {
  for (const char* path : {"../secret", "/etc/passwd", "a/../../b"})
    EXPECT_THROW(
        ParseManifest(
            fmt::format(
                R"({{"schema_version": 1, "key": "", "files": [{{"path": "{}", "bytes": 1, "hash": ""}}]}})",
                path),
            "m"),
        InputError);
}

TEST_F(OutputFolderTest, DamagedCheckpointsAndThoseOfOthersAreNotUsed) {
  const OutputFolder folder(base_ / "out", FolderUse::kResults);
  EXPECT_FALSE(folder.ReadCheckpoint("key"));
  folder.WriteCheckpoint("key", "content");
  EXPECT_EQ(folder.ReadCheckpoint("key"), "content");
  const fs::path file = base_ / "out" / "checkpoints" / "key.cbor";
  std::string bytes = ReadFile(file);
  WriteFileAtomically(base_ / "out" / "checkpoints" / "other.cbor", bytes);
  EXPECT_FALSE(folder.ReadCheckpoint("other"));
  for (const size_t at : {size_t{0}, bytes.size() - 1}) {
    std::string damaged = bytes;
    damaged[at] ^= 1;
    WriteFileAtomically(file, damaged);
    EXPECT_FALSE(folder.ReadCheckpoint("key"));
  }
  WriteFileAtomically(file, "short");
  EXPECT_FALSE(folder.ReadCheckpoint("key"));
  folder.RemoveCheckpoints();
  EXPECT_FALSE(fs::exists(file));
}

}  // namespace
}  // namespace millpose
