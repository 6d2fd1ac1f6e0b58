// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/file.hpp"

#include <unistd.h>

#include "base/error.hpp"

namespace millpose {
namespace {

class File : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / fmt::format("millpose_file_{}", ::getpid());
};

TEST_F(File, WhatIsWrittenIsReadAndNothingElseIsLeft) {
  const std::string bytes("a\0b\n", 4);
  WriteFileAtomically(folder_ / "x", "older");
  WriteFileAtomically(folder_ / "x", bytes);
  EXPECT_EQ(ReadFile(folder_ / "x"), bytes);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(File, RefusesWhatIsNoFileOrTooLarge) {
  EXPECT_THROW(ReadFile(folder_ / "missing"), InputError);
  EXPECT_THROW(ReadFile(folder_), InputError);
  WriteFileAtomically(folder_ / "x", "12345");
  EXPECT_THROW(ReadFile(folder_ / "x", 4), InputError);
  EXPECT_THROW(WriteFileAtomically(folder_ / "no" / "x", ""), InputError);
}

}  // namespace
}  // namespace millpose
