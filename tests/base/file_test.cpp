// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/file.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>

#include "base/error.hpp"
#include "base/parallel.hpp"

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

// A FIFO without a writer, opened, waits for one; a socket and a device say what they are.
TEST_F(File, WhatIsNoFileIsNotOpened) {
  const auto refusal = [&](const std::filesystem::path& path) {
    try {
      ReadFile(path);
    } catch (const InputError& error) {
      return std::string(error.problems().at(0).message);
    }
    return std::string("read");
  };
  ::alarm(20);  // what waits ends the test
  ASSERT_EQ(::mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  EXPECT_EQ(refusal(folder_ / "fifo"), "not a regular file but a FIFO");
  std::filesystem::create_symlink(folder_ / "fifo", folder_ / "link");
  EXPECT_EQ(refusal(folder_ / "link"), "not a regular file but a FIFO");
  EXPECT_EQ(refusal("/dev/zero"), "not a regular file but a device");
  EXPECT_EQ(refusal(folder_), "not a regular file but a folder");
  const int listener = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{.sun_family = AF_UNIX, .sun_path = {}};
  const std::string name = (folder_ / "socket").string();
  ASSERT_LT(name.size(), sizeof address.sun_path);
  name.copy(address.sun_path, name.size());
  ASSERT_EQ(::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(refusal(name), "not a regular file but a socket");
  ::close(listener);
  ::alarm(0);
}

// Threads of one process too: each has a temporary file of its own.
TEST_F(File, ReadersSeeOneWholeContentWhateverWritersDo) {
  const std::filesystem::path file = folder_ / "x";
  WriteFileAtomically(file, std::string(1000, 'a'));
  std::atomic<int> torn = 0;
  ParallelFor(8, 8, {}, [&](size_t i) {
    for (int k = 0; k < 12; ++k) {
      const char letter = static_cast<char>('a' + i);
      if (i % 2 == 0) WriteFileAtomically(file, std::string(1000 * (i + 1), letter));
      const std::string seen = ReadFile(file);
      if (seen != std::string(1000 * static_cast<size_t>(seen[0] - 'a' + 1), seen[0])) ++torn;
    }
  });
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(EntriesOf(folder_).size(), 1u);
}

TEST_F(File, WhatFailsLeavesTheOldContentAndNothingElse) {
  std::filesystem::create_directories(folder_ / "taken" / "inside");
  try {
    WriteFileAtomically(folder_ / "taken", "new");  // a folder cannot be replaced by a file
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("taken: cannot write: "), std::string::npos) << error.what();
  }
  EXPECT_TRUE(std::filesystem::is_directory(folder_ / "taken" / "inside"));
  EXPECT_EQ(EntriesOf(folder_).size(), 1u);
}

TEST_F(File, FoldersAreMadeListedRenamedAndRemoved) {
  MakeFolders(folder_ / "a" / "b");
  MakeFolders(folder_ / "a" / "b");
  for (const char* name : {"z", "k", "m"}) WriteFileAtomically(folder_ / "a" / name, name);
  const std::vector<std::filesystem::path> sorted{folder_ / "a/b", folder_ / "a/k", folder_ / "a/m",
                                                  folder_ / "a/z"};
  EXPECT_EQ(EntriesOf(folder_ / "a"), sorted);
  EXPECT_TRUE(EntriesOf(folder_ / "none").empty());
  Rename(folder_ / "a", folder_ / "c");
  EXPECT_FALSE(Exists(folder_ / "a"));
  EXPECT_EQ(ReadFile(folder_ / "c" / "m"), "m");
  SyncFolder(folder_ / "c");
  RemoveAll(folder_ / "c");
  RemoveAll(folder_ / "c");
  EXPECT_FALSE(Exists(folder_ / "c"));
}

TEST_F(File, EveryStepThatFailsNamesItsPath) {
  WriteFileAtomically(folder_ / "file", "");
  const std::vector<std::function<void()>> steps{
      [&] { MakeFolders(folder_ / "file" / "below"); }, [&] { Rename(folder_ / "none", folder_ / "new"); },
      [&] { EntriesOf(folder_ / "file"); }, [&] { SyncFolder(folder_ / "none"); },
      [&] { ReadFile(folder_ / "none"); }};
  for (const auto& step : steps) {
    try {
      step();
      ADD_FAILURE();
    } catch (const InputError& error) {
      EXPECT_TRUE(error.problems().at(0).place.file.starts_with(folder_.string())) << error.what();
    }
  }
}

}  // namespace
}  // namespace millpose
