// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/folder.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.hpp"
#include "tests/base/refusal.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;
using EntryKind = Folder::Kind;

class FolderTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(top_ / "own" / "sub");
    fs::create_directories(top_ / "outside");
    WriteFileAtomically(top_ / "outside" / "victim", "theirs");
    WriteFileAtomically(top_ / "own" / "file", "ours");
    fs::create_symlink("../outside", top_ / "own" / "way_out");
    fs::create_symlink("../outside/victim", top_ / "own" / "link");
    ASSERT_EQ(::mkfifo((top_ / "own" / "pipe").c_str(), 0600), 0);
  }
  void TearDown() override { fs::remove_all(top_); }

  const fs::path top_ = fs::temp_directory_path() / fmt::format("millpose_folder_{}", ::getpid());
};

TEST_F(FolderTest, WhatStandsInIt) {
  const Folder folder(top_ / "own");
  EXPECT_EQ(folder.Names(), (std::vector<std::string>{"file", "link", "pipe", "sub", "way_out"}));
  EXPECT_EQ(folder.KindOf("file"), EntryKind::kFile);
  EXPECT_EQ(folder.KindOf("sub"), EntryKind::kFolder);
  for (const char* name : {"link", "pipe", "way_out"})
    EXPECT_EQ(folder.KindOf(name), EntryKind::kOther) << name;
  for (const char* name : {"none", "sub/none", "none/below"})
    EXPECT_EQ(folder.KindOf(name), EntryKind::kNothing) << name;
  folder.Write("a/b/c", "new");
  EXPECT_EQ(folder.Read("a/b/c"), "new");
  EXPECT_EQ(folder.Below("a").Names(), std::vector<std::string>{"b"});
  EXPECT_FALSE(folder.FindBelow("a/x"));
  EXPECT_NE(RefusalOf([&] { folder.Below("a/x"); }).find("a/x: cannot open"), std::string::npos);
  EXPECT_NE(RefusalOf([&] { folder.Read("file", 3); }).find("4 bytes, at most 3"), std::string::npos);
  EXPECT_EQ(Folder::Made(top_ / "new" / "one").Names().size(), 0U);
}

// Also none that hangs: a pipe that nobody writes to is not opened.
TEST_F(FolderTest, NothingLeadsOut) {
  const Folder folder(top_ / "own");
  const fs::path outside = top_ / "outside" / "victim";
  for (const char* name : {"", ".", "..", "../outside/victim", "/etc/passwd", "sub/../../outside/victim",
                           "way_out/victim", "link", "pipe", "sub"})
    EXPECT_NE(RefusalOf([&] { folder.Read(name); }), "accepted") << name;
  for (const char* name : {"", "..", "../outside/victim", "way_out/victim", "way_out/new", "sub/../x"})
    EXPECT_NE(RefusalOf([&] { folder.Write(name, "ours"); }), "accepted") << name;
  for (const char* name : {"", ".", "..", "../outside", "way_out/victim", "/"}) {
    EXPECT_NE(RefusalOf([&] { folder.RemoveAll(name); }), "accepted") << name;
    EXPECT_NE(RefusalOf([&] { folder.Move(name, folder.Below("sub")); }), "accepted") << name;
  }
  for (const char* name : {"..", "way_out", "pipe", "file"}) {
    EXPECT_NE(RefusalOf([&] { folder.Below(name); }), "accepted") << name;
    EXPECT_NE(RefusalOf([&] { folder.MakeBelow(fs::path(name) / "more"); }), "accepted") << name;
  }
  for (const char* name : {"link", "pipe", "sub", "way_out"})
    EXPECT_NE(RefusalOf([&] { folder.OpenForLock(name); }), "accepted") << name;
  EXPECT_NE(RefusalOf([&] { folder.Read("link"); }).find("own/link: is a symbolic link"), std::string::npos);
  EXPECT_EQ(ReadFile(outside), "theirs");
  EXPECT_EQ(Folder(top_ / "outside").Names(), std::vector<std::string>{"victim"});
}

// A link is moved, replaced and removed as the entry that it is.
TEST_F(FolderTest, LinksAreEntries) {
  const Folder folder(top_ / "own"), sub = folder.Below("sub");
  folder.Write("link", "ours now");
  EXPECT_EQ(folder.KindOf("link"), EntryKind::kFile);
  for (const char* name : {"way_out", "pipe"}) {
    folder.Move(name, sub);
    EXPECT_EQ(sub.KindOf(name), EntryKind::kOther);
  }
  folder.RemoveAll("sub");
  EXPECT_EQ(folder.Names(), (std::vector<std::string>{"file", "link"}));
  EXPECT_EQ(ReadFile(top_ / "outside" / "victim"), "theirs");
}

TEST_F(FolderTest, MoveReplacesWhateverIsThere) {
  const Folder folder(top_ / "own"), sub = folder.Below("sub");
  sub.Write("file/below", "a folder of this name");
  folder.Move("file", sub);
  EXPECT_EQ(sub.Read("file"), "ours");
  folder.Write("file/below", "a folder of this name");
  const std::string before = sub.Identity("file");
  folder.Move("file", sub);
  EXPECT_EQ(sub.Read("file/below"), "a folder of this name");
  EXPECT_NE(sub.Identity("file"), before);
  EXPECT_EQ(sub.Identity("none"), "");
  sub.Sync();
}

}  // namespace
}  // namespace millpose
