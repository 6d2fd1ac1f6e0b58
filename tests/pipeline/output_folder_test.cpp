// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/output_folder.hpp"

#include <unistd.h>

#include "base/error.hpp"
#include "base/file.hpp"

namespace millpose {
namespace {
namespace fs = std::filesystem;

class OutputFolderTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(base_); }
  void TearDown() override { fs::remove_all(base_); }
  const fs::path base_ = fs::temp_directory_path() / fmt::format("millpose_output_{}", ::getpid());
};

TEST_F(OutputFolderTest, TakesOnlyWhatIsItsOwn) {
  fs::create_directories(base_ / "theirs");
  WriteFileAtomically(base_ / "theirs" / "thesis.txt", "years of work");
  WriteFileAtomically(base_ / "file", "");
  EXPECT_THROW(OutputFolder(base_ / "theirs"), InputError);
  EXPECT_THROW(OutputFolder(base_ / "file"), InputError);
  EXPECT_EQ(ReadFile(base_ / "theirs" / "thesis.txt"), "years of work");
  const OutputFolder first(base_ / "ours");
  first.Write("points.csv", "1");
  const OutputFolder second(base_ / "ours");
  second.RemoveResults();
  EXPECT_FALSE(fs::exists(base_ / "ours" / "points.csv"));
  EXPECT_NO_THROW(OutputFolder(base_ / "ours"));
}

TEST_F(OutputFolderTest, WhatAKilledRunLeftHalfWrittenIsRemoved) {
  OutputFolder(base_ / "out").WriteCheckpoint("key", "content");
  const fs::path half = base_ / "out" / "checkpoints" / "other.cbor.123.tmp";
  WriteFileAtomically(half, "con");
  OutputFolder(base_ / "out").RemoveResults();
  EXPECT_EQ(OutputFolder(base_ / "out").ReadCheckpoint("key"), "content");
  EXPECT_FALSE(fs::exists(half));
}

TEST_F(OutputFolderTest, AFolderWhoseMarkWasNotFinishedIsTaken) {
  std::filesystem::create_directories(base_ / "killed");
  WriteFileAtomically(base_ / "killed" / ".millpose.host.1.tmp", "This fol");
  EXPECT_NO_THROW(OutputFolder(base_ / "killed"));
  EXPECT_TRUE(IsOutputFolder(base_ / "killed"));
}

TEST_F(OutputFolderTest, ProgramsAppearTogether) {
  const OutputFolder folder(base_ / "out");
  folder.WritePrograms({{"krl/a.src", "x"}, {"krl/a.dat", "y"}, {"linuxcnc/a.ngc", "z"}});
  EXPECT_EQ(ReadFile(base_ / "out" / "programs" / "krl" / "a.dat"), "y");
  EXPECT_FALSE(fs::exists(base_ / "out" / "programs.unfinished"));
}

TEST_F(OutputFolderTest, DamagedCheckpointsAreNotUsed) {
  const OutputFolder folder(base_ / "out");
  EXPECT_FALSE(folder.ReadCheckpoint("key"));
  folder.WriteCheckpoint("key", "content");
  EXPECT_EQ(folder.ReadCheckpoint("key"), "content");
  folder.RemoveResults();
  EXPECT_EQ(folder.ReadCheckpoint("key"), "content");
  const fs::path file = base_ / "out" / "checkpoints" / "key.cbor";
  std::string bytes = ReadFile(file);
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
