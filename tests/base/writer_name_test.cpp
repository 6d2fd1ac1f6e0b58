// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/writer_name.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace millpose {
namespace {

/// `name` with one of its parts, counted from behind, replaced.
std::string With(std::string name, size_t part, const std::string& text) {
  size_t end = name.size();
  for (size_t i = 0; i < part; ++i) end = name.rfind('.', end - 1);
  const size_t begin = name.rfind('.', end - 1) + 1;
  return name.replace(begin, end - begin, text);
}

TEST(WriterName, SaysWhoWrites) {
  for (const char* of : {"cell.yaml", "a", ".millpose", "a.b.1.2.3"}) {
    const std::string name = TemporaryName(of);
    EXPECT_TRUE(name.starts_with(fmt::format(".{}.", of))) << name;
    EXPECT_NE(name.find(fmt::format(".{}.", ::getpid())), std::string::npos) << name;
    EXPECT_NE(name, TemporaryName(of));
    EXPECT_TRUE(IsTemporaryName(name));
    EXPECT_FALSE(IsOfEndedWriter(name)) << "this process lives";
    EXPECT_FALSE(IsOfNoWriterHere(name));
    const std::string gone = With(name, 3, "4194305");  // larger than any process number
    EXPECT_TRUE(IsOfEndedWriter(gone)) << gone;
    const std::string before = With(name, 2, "1");  // the same number, before this process began
    EXPECT_TRUE(IsOfEndedWriter(before)) << before;
    const std::string elsewhere = With(gone, 4, "another");
    EXPECT_FALSE(IsOfEndedWriter(elsewhere)) << elsewhere;
    EXPECT_TRUE(IsOfNoWriterHere(elsewhere));
  }
  EXPECT_EQ(TemporaryBeside("a/b").parent_path(), "a");
  EXPECT_LT(TemporaryName(std::string(255, 'x')).size(), 255U);
}

TEST(WriterName, OtherNamesAreNobodys) {
  for (const char* name :
       {"", ".tmp", "notes.tmp", ".notes.tmp", ".a.host.1.2.3", "a.host.1.2.3.tmp", ".a.host.1.2.x.tmp",
        ".a.host.1..3.tmp", ".a.host.-1.2.3.tmp", ".1.2.3.tmp", "cell.yaml", ".owner.host.1.2"}) {
    EXPECT_FALSE(IsTemporaryName(name)) << name;
    EXPECT_FALSE(IsOfEndedWriter(name)) << name;
    EXPECT_FALSE(IsOfNoWriterHere(name)) << name;
  }
}

}  // namespace
}  // namespace millpose
