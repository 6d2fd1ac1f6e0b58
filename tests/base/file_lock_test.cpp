// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/file_lock.hpp"

#include <unistd.h>

#include <thread>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/process.hpp"

namespace millpose {
namespace {

using Kind = FileLock::Kind;
using Outcome = FileLock::Outcome;

class Lock : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }
  const std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / fmt::format("millpose_lock_{}", ::getpid());
};

TEST_F(Lock, OneMayHaveItAloneOrManyMayShareIt) {
  for (const bool first_alone : {false, true})
    for (const bool second_alone : {false, true}) {
      FileLock first(file_), second(file_);
      ASSERT_EQ(first.Take(first_alone ? Kind::kExclusive : Kind::kShared), Outcome::kHeld);
      EXPECT_EQ(second.Take(second_alone ? Kind::kExclusive : Kind::kShared),
                first_alone || second_alone ? Outcome::kBusy : Outcome::kHeld)
          << first_alone << second_alone;
    }
}

TEST_F(Lock, EndsWithItsObject) {
  {
    FileLock first(file_);
    ASSERT_EQ(first.Take(Kind::kExclusive), Outcome::kHeld);
  }
  FileLock next(file_);
  EXPECT_EQ(next.Take(Kind::kExclusive), Outcome::kHeld);
}

TEST_F(Lock, BecomesSharedAndAloneAgain) {
  FileLock first(file_), second(file_);
  ASSERT_EQ(first.Take(Kind::kExclusive), Outcome::kHeld);
  ASSERT_EQ(first.Take(Kind::kShared), Outcome::kHeld);
  EXPECT_EQ(second.Take(Kind::kShared), Outcome::kHeld);
  EXPECT_EQ(first.Take(Kind::kExclusive), Outcome::kBusy);
}

TEST_F(Lock, HoldsBetweenThreads) {
  FileLock own(file_);
  ASSERT_EQ(own.Take(Kind::kExclusive), Outcome::kHeld);
  Outcome other = Outcome::kHeld;
  std::thread([&] { other = FileLock(file_).Take(Kind::kShared); }).join();
  EXPECT_EQ(other, Outcome::kBusy);
}

// Locks of POSIX's older kind end when any descriptor of the file is closed; these do not.
TEST_F(Lock, OutlivesOtherUsersOfTheFile) {
  FileLock own(file_);
  ASSERT_EQ(own.Take(Kind::kExclusive), Outcome::kHeld);
  EXPECT_EQ(ReadFile(file_), "");
  { FileLock other(file_); }
  EXPECT_EQ(FileLock(file_).Take(Kind::kShared), Outcome::kBusy);
}

TEST_F(Lock, IsNotInheritedByChildren) {
  std::optional<FileLock> own(std::in_place, file_);
  ASSERT_EQ(own->Take(Kind::kExclusive), Outcome::kHeld);
  std::jthread child([] { RunProcess({"sleep", "0.5"}, {}); });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  own.reset();
  EXPECT_EQ(FileLock(file_).Take(Kind::kExclusive), Outcome::kHeld);
}

TEST_F(Lock, AFileThatCannotBeMadeIsNamed) {
  try {
    FileLock lock(file_ / "below a file that is none");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems().at(0).place.file, file_.string());  // is a file, so nothing can lie in it
  }
}

}  // namespace
}  // namespace millpose
