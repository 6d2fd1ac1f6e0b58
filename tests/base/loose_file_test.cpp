// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/loose_file.hpp"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/writer_name.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

class LooseFile : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_ / "elsewhere"); }
  void TearDown() override { fs::remove_all(folder_); }

  std::vector<std::string> Names(const fs::path& folder) const {
    std::vector<std::string> names;
    for (const fs::path& entry : EntriesOf(folder)) names.push_back(entry.filename().string());
    return names;
  }
  static mode_t ModeOf(const fs::path& path) {
    struct stat info {};
    EXPECT_EQ(::lstat(path.c_str(), &info), 0);
    return info.st_mode & 07777;
  }

  const fs::path folder_ = fs::temp_directory_path() / fmt::format("millpose_loose_{}", ::getpid());
};

TEST_F(LooseFile, ANewFileIsWrittenAndNothingElseIsLeft) {
  WriteLooseFile(folder_ / "x.yaml", "first");
  WriteLooseFile(folder_ / "x.yaml", "second");
  EXPECT_EQ(ReadFile(folder_ / "x.yaml"), "second");
  EXPECT_EQ(Names(folder_), (std::vector<std::string>{"elsewhere", "x.yaml"}));
  EXPECT_THROW(WriteLooseFile(folder_ / "no" / "x", ""), InputError);
}

TEST_F(LooseFile, AnEditFollowsLinksAndTheFileBehindThemKeepsItsMode) {
  const fs::path file = folder_ / "elsewhere" / "cell.yaml";
  WriteFileAtomically(file, "old");
  ::chmod(file.c_str(), 0640);
  fs::create_symlink("elsewhere/cell.yaml", folder_ / "relative");
  fs::create_symlink(folder_ / "relative", folder_ / "chain");
  for (const std::string name : {"relative", "chain"}) {
    EditLooseFile(folder_ / name, [&](const std::string&) { return name; });
    EXPECT_TRUE(fs::is_symlink(folder_ / name));
    EXPECT_EQ(ReadFile(file), name);
    EXPECT_EQ(ModeOf(file), 0640u);
  }
  fs::create_symlink("b", folder_ / "a");
  fs::create_symlink("a", folder_ / "b");
  EXPECT_THROW(EditLooseFile(folder_ / "a", [](const std::string&) { return ""; }), InputError);
}

// It may stand in a folder of somebody who is not trusted.
TEST_F(LooseFile, AResultIsNeverWrittenThroughALink) {
  WriteFileAtomically(folder_ / "elsewhere" / "victim", "untouched");
  fs::create_symlink("elsewhere/victim", folder_ / "to_victim");
  fs::create_symlink("elsewhere/new", folder_ / "to_nothing");
  fs::create_symlink("to_itself", folder_ / "to_itself");
  for (const char* name : {"to_victim", "to_nothing", "to_itself"}) {
    WriteLooseFile(folder_ / name, "result");
    EXPECT_FALSE(fs::is_symlink(folder_ / name));
    EXPECT_EQ(ReadFile(folder_ / name), "result");
    EXPECT_EQ(ModeOf(folder_ / name), 0644u);
  }
  EXPECT_EQ(ReadFile(folder_ / "elsewhere" / "victim"), "untouched");
  EXPECT_EQ(Names(folder_ / "elsewhere"), std::vector<std::string>{"victim"});
}

TEST_F(LooseFile, TheOwnerStays) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give files away";
  const fs::path file = folder_ / "cell.yaml";
  WriteFileAtomically(file, "old");
  ASSERT_EQ(::chown(file.c_str(), 1234, 4321), 0);
  ASSERT_EQ(::chmod(file.c_str(), 02664), 0);
  WriteLooseFile(file, "new");
  struct stat info {};
  ASSERT_EQ(::stat(file.c_str(), &info), 0);
  EXPECT_EQ(info.st_uid, 1234u);
  EXPECT_EQ(info.st_gid, 4321u);
  EXPECT_EQ(ModeOf(file), 02664u);

  // Who may not give it away must not take it either: the file stays as it is.
  fs::permissions(folder_, fs::perms::all);
  const pid_t child = ::fork();
  if (child == 0) {
    if (::setgid(4321) != 0 || ::setuid(999) != 0) ::_exit(9);
    try {
      WriteLooseFile(file, "taken");
    } catch (const InputError& error) {
      ::_exit(std::string(error.what()).find("belongs to user 1234") != std::string::npos ? 0 : 1);
    }
    ::_exit(2);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(ReadFile(file), "new");
  EXPECT_EQ(Names(folder_), (std::vector<std::string>{"cell.yaml", "elsewhere"}));
}

TEST_F(LooseFile, WhatIsNoFileIsRefusedAtOnce) {
  ASSERT_EQ(::mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  fs::create_symlink("fifo", folder_ / "to_fifo");
  fs::create_symlink("/dev/null", folder_ / "device");
  for (const char* name : {"fifo", "to_fifo", "device", "elsewhere"}) {
    EXPECT_THROW(WriteLooseFile(folder_ / name, "x"), InputError) << name;
    EXPECT_EQ(Names(folder_).size(), 4u) << name;
  }
}

TEST_F(LooseFile, WhatAKilledWriterLeftGoesAndWhatAnotherWritesStays) {
  const pid_t ended = ::fork();
  if (ended == 0) ::_exit(0);
  int status = 0;
  ASSERT_EQ(::waitpid(ended, &status, 0), ended);
  const std::string own = TemporaryName("x");
  const auto of = [&](pid_t process) {
    std::string name = own;
    const std::string mine = fmt::format(".{}.", ::getpid());
    return name.replace(name.rfind(mine), mine.size(), fmt::format(".{}.", process));
  };
  const std::string gone = of(ended), elsewhere = ".x.other_host.1.1.0.tmp";
  for (const std::string& name : {own, gone, elsewhere, gone.substr(1), std::string("x.tmp")})
    WriteFileAtomically(folder_ / name, "part");
  WriteLooseFile(folder_ / "y", "whole");
  EXPECT_FALSE(fs::exists(folder_ / gone));
  for (const std::string& name : {own, elsewhere, gone.substr(1), std::string("x.tmp")})
    EXPECT_TRUE(fs::exists(folder_ / name)) << name;
}

TEST_F(LooseFile, AnEditThatChangesNothingWritesNothing) {
  WriteFileAtomically(folder_ / "x", "as it is");
  struct stat before {
  }, after{};
  ASSERT_EQ(::stat((folder_ / "x").c_str(), &before), 0);
  EditLooseFile(folder_ / "x", [](const std::string& text) { return text; });
  ASSERT_EQ(::stat((folder_ / "x").c_str(), &after), 0);
  EXPECT_EQ(before.st_ino, after.st_ino);
  EditLooseFile(folder_ / "x", [](const std::string& text) { return text + "\r\n"; });
  EXPECT_EQ(ReadFile(folder_ / "x"), "as it is\r\n");
}

}  // namespace
}  // namespace millpose
