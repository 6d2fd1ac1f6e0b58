// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/file_root.hpp"

#include <unistd.h>

#include "base/error.hpp"
#include "base/file.hpp"

namespace millpose {
namespace {
namespace fs = std::filesystem;

class InRoot : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(top_ / "root" / "sub");
    fs::create_directories(top_ / "root_not");
    WriteFileAtomically(top_ / "secret", "secret");
    WriteFileAtomically(top_ / "root_not" / "file", "secret");
    WriteFileAtomically(top_ / "root" / "sub" / "file", "own");
  }
  void TearDown() override { fs::remove_all(top_); }

  const fs::path top_ = fs::temp_directory_path() / fmt::format("millpose_root_{}", ::getpid());
  fs::path root() const { return top_ / "root"; }
};

TEST_F(InRoot, WhatLiesWithinIsRead) {
  const FileRoot bound(root());
  fs::create_symlink("sub/file", root() / "link");
  fs::create_directory_symlink("sub", root() / "folder");
  for (const fs::path& path :
       {root() / "sub/file", root() / "link", root() / "folder/file", root() / "sub/../sub/file"})
    EXPECT_EQ(bound.Read(path), "own") << path;
  EXPECT_EQ(FileRoot().Read(top_ / "secret"), "secret");
}

TEST_F(InRoot, NothingOutsideIsRead) {
  const FileRoot bound(root());
  fs::create_symlink(top_ / "secret", root() / "link");
  fs::create_symlink("../secret", root() / "relative");
  fs::create_symlink("link", root() / "chain");
  fs::create_directory_symlink("..", root() / "sub" / "up");
  fs::create_directory_symlink("../..", root() / "sub" / "upper");
  for (const fs::path& path : {top_ / "secret", root() / "../secret", root() / "link", root() / "relative",
                               root() / "chain", root() / "sub/upper/secret", top_ / "root_not/file",
                               fs::path("/etc/passwd"), root() / "none/../../secret"}) {
    try {
      bound.Read(path);
      ADD_FAILURE() << path;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("lies outside of"), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(bound.Read(root() / "sub/up/sub/file"), "own");
}

TEST_F(InRoot, NothingIsWrittenThroughALink) {
  const FileRoot bound(root());
  EXPECT_NO_THROW(bound.CheckFolder(root() / "new.out"));
  EXPECT_THROW(bound.CheckFolder(top_ / "new.out"), InputError);
  fs::create_directory_symlink(top_ / "root_not", root() / "link.out");
  EXPECT_THROW(bound.CheckFolder(root() / "link.out"), InputError);
  fs::create_directory(root() / "old.out");
  fs::create_directory_symlink(top_ / "root_not", root() / "old.out" / "programs");
  EXPECT_THROW(bound.CheckFolder(root() / "old.out"), InputError);
}

TEST_F(InRoot, ARootMustBeAFolder) {
  EXPECT_THROW(FileRoot(root() / "none"), InputError);
  EXPECT_THROW(FileRoot(top_ / "secret"), InputError);
}

}  // namespace
}  // namespace millpose
