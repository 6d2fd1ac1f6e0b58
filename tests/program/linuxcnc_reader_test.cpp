// SPDX-License-Identifier: GPL-3.0-or-later
// What the LinuxCNC reader allows where, beside what the real interpreter makes of the same text.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "program/linuxcnc/linuxcnc.hpp"
#include "tests/program/interpreter.hpp"
#include "tests/program/text_places.hpp"

namespace millpose {
namespace {

class LinuxCncReading : public testing::TestWithParam<std::string> {
 protected:
  TextPlaces sample{GetParam()};
  const std::string cut = "\nG1 X", way = "\nG0 X";

  void Refuses(const std::string& line, const std::string& at, int nth, const std::string& hint) {
    sample.ExpectRefused(sample.Inserted(line, at, nth), line, hint);
  }
  /// The reader and the interpreter take the text; both find the same motions in it.
  void Takes(const std::string& text, const std::string& what) {
    EXPECT_EQ(sample.Problems(text), "") << what;
    if (sample.Problems(text).empty()) ExpectInterpreted(text, sample.Read(text));
  }
};
INSTANTIATE_TEST_SUITE_P(Coordinates, LinuxCncReading, testing::Values("linuxcnc", "linuxcnc_cartesian"),
                         [](const auto& variant) { return variant.param; });

TEST_P(LinuxCncReading, CodeBetweenTwoCommentsIsCode) {
  const std::string text = sample.Inserted("(a) G4 P1 (b)", way, 2);
  Takes(text, "a dwell between comments");
  Refuses("(a) G4 P1 (b)", cut, 3, "is not allowed in a cut");
  Refuses("(a) G20 (b)", cut, 3, "");
  Refuses("(a) M5 (b)", cut, 3, "");
  Takes(sample.Inserted("(a) (b)", cut, 3), "two comments");
  Takes(sample.Inserted("(a ; b)", cut, 3), "a semicolon in a comment");
  Refuses("(a (b) c)", cut, 3, "");
  Refuses("(a", cut, 3, "");
}

TEST_P(LinuxCncReading, NothingStopsInACut) {
  for (const std::string line : {"M0", "M1", "G4 P0.5", "G49", "G92.1", "G59.3"}) {
    Refuses(line, cut, 3, "is not allowed in a cut");
    Takes(sample.Inserted(line, way, 2), line);
  }
  Refuses("G10 L2 P9 X0 Y0 Z0 A0 B0 C0 R0", cut, 3, "is not allowed");
}

TEST_P(LinuxCncReading, PointsAreNotMerged) {
  sample.ExpectRefused(sample.Changed("\nG64 P", "\nG64 P0.01 ; P"), "G64 without Q", "G64 needs Q0");
  sample.ExpectRefused(sample.Changed("\nG64 P", "\nG64 P0.01 Q0.05 ; P"), "G64 with Q", "G64 needs Q0");
  sample.ExpectRefused(sample.Changed("\nG61.1\n", "\nG64 P0.01 Q0\n"), "ways that are rounded", "");
}

TEST_P(LinuxCncReading, WhatIsLegalIsTaken) {
  Takes("%\n" + sample.text() + "%\n", "a pair of %");
  Takes(sample.Changed("G21 G90", "G 21 g9 0"), "blanks in numbers");
  for (const std::string line : {"G90", "G17 G40", "N10 G21", "n 1 0", "(here)", "", "G90 (a) G17 (b) ; c"})
    Takes(sample.Inserted(line, cut, 3), line);
  Refuses("%", cut, 3, "% in the first line");
  sample.ExpectRefused("%\n" + sample.text() + "%\nG0 X0\n", "code behind the last %", "");
}

TEST_P(LinuxCncReading, WhatTheInterpreterRefusesIsRefused) {
  for (const std::string line :
       {"G1 G1", "G90 G91", "F1 F2", "G90 X1e1", "G1 X1 X2", "G90 P3", "G90 Q0", "M62", "G4", "G4 P-1",
        "G90 L2", "N1 N2", "G90 N5", "X--", "M62 P1 M63 P2", "Z."}) {
    const std::string text = sample.Inserted(line, cut, 3);
    EXPECT_NE(sample.Problems(text), "") << line;
    EXPECT_NE(Interpret(text).status, 0) << line;
  }
  const std::string longest = "G90 ;" + std::string(245, 'x');
  Takes(sample.Inserted(longest, cut, 3), "a line of 250 characters");
  Refuses(longest + "x", cut, 3, "at most 250 characters");
  EXPECT_NE(Interpret(sample.Inserted(longest + "xxx", cut, 3)).status, 0);
}

TEST_P(LinuxCncReading, TheInterpretersWholeNumbers) {
  Takes(sample.Inserted("G90.00005", cut, 3), "a code within 0.0001");
  Refuses("G90.001", cut, 3, "");
  Refuses("M62 P1.5", cut, 3, "whole number of an output");
}

TEST_P(LinuxCncReading, NumbersHaveBounds) {
  sample.ExpectRefused(sample.Changed("G1 X", "G1 X1000000 ;"), "a million", "a number from");
  sample.ExpectRefused(sample.Changed("G1 X", "G1 X1e308 ;"), "1e308", "");
}

TEST_P(LinuxCncReading, ARepeatedG94NeedsItsFeed) {
  // The interpreter sets the feed to 0 where G94 comes again.
  const std::string text =
      sample.Inserted("G94", GetParam() == "linuxcnc" ? "\nM2" : cut, GetParam() == "linuxcnc" ? 0 : 3);
  EXPECT_EQ(sample.Problems(text).empty(), Interpret(text).status == 0) << sample.Problems(text);
}

/// A control that is built on LinuxCNC.
class DerivedPost final : public LinuxCncPost {
 public:
  using LinuxCncPost::LinuxCncPost;
  std::string Name() const override { return "derived"; }
  std::vector<std::string> Endings() const override { return {".nc"}; }
};

TEST(DerivedLinuxCnc, HasItsOwnNameAndEnding) {
  const DerivedPost post;
  PostSettings settings = SampleSettings("derived");
  const PlanResult plan = SamplePlan();
  const ProgramFiles files = post.Write(MakeMotionProgram(plan), plan.arm, settings);
  ASSERT_EQ(files.size(), 1u);
  EXPECT_TRUE(files.begin()->first.ends_with(".nc")) << files.begin()->first;
  EXPECT_EQ(post.Write(post.Read(files, plan.arm, settings), plan.arm, settings), files);
  EXPECT_THROW(LinuxCncPost().Read(files, plan.arm, settings), InputError);
  EXPECT_EQ(post.Calling().ending, ".nc");
  EXPECT_EQ(post.Calling().called_ending, ".nc");
  settings.controller_axes = {ControllerAxis{.name = "U", .axis = "rail", .coupled = true}};
  EXPECT_TRUE(post.WhyNotIn(settings).starts_with("controllers.derived.external_axes:"))
      << post.WhyNotIn(settings);
}

}  // namespace
}  // namespace millpose
