// SPDX-License-Identifier: GPL-3.0-or-later
// A controller that a program brings along, whose programs end like those of another.
#include <gtest/gtest.h>

#include "program/linuxcnc/linuxcnc.hpp"
#include "program/post_entry.hpp"
#include "run/pipeline/programs/verify_programs.hpp"
#include "tests/run/pipeline/small_job.hpp"

namespace millpose::test {
namespace {

class OtherPost final : public LinuxCncPost {
 public:
  using LinuxCncPost::LinuxCncPost;
  std::string Name() const override { return "other"; }
};

const bool kAdded = [] {
  Posts().Add(EntryOf<OtherPost>({ToolAxisKey()}));
  return true;
}();

std::string VerifiedAs(const TestFolder& folder) {
  VerifyArguments arguments;
  arguments.cell = folder.path() / "cell.yaml";
  arguments.target = folder.path() / "part.ngc";
  const std::vector<VerifiedProgram> programs = VerifyPrograms(arguments, Silent(), {});
  return programs.empty() ? "" : programs[0].controller;
}

TEST(OwnController, ItsProgramsAreReadAsItsOwnWhereTheCellHasIt) {
  ASSERT_TRUE(kAdded);
  const TestFolder folder("own_controller");
  CopySmallJob(folder);
  folder.Write("part.ngc", ReadFile(SamplePath("tests/golden/linuxcnc/Sample_wall_plan.ngc")));
  EXPECT_EQ(VerifiedAs(folder), "linuxcnc");
  folder.Change("cell.yaml", "\n  linuxcnc:", "\n  other:");
  EXPECT_EQ(VerifiedAs(folder), "other");
}

TEST(MainEndings, NameEachOnce) {
  const std::vector<std::string> endings = MainEndings();
  EXPECT_EQ(std::ranges::count(endings, ".ngc"), 1);
  EXPECT_EQ(endings.front(), ".src");
}

}  // namespace
}  // namespace millpose::test
