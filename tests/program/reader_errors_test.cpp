// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "program/linuxcnc/linuxcnc.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

/// A text of the sample with the first `from` replaced, read again: the problems.
std::vector<Problem> ProblemsWith(const std::string& controller, const std::string& from,
                                  const std::string& to) {
  const auto post = MakePost(controller);
  const PlanResult plan = SamplePlan();
  const PostSettings settings = SampleSettings(controller);
  ProgramFiles files = post->Write(MakeMotionProgram(plan), plan.arm, settings);
  std::string& text = files.rbegin()->second;  // .src comes after .dat
  const size_t place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  text.replace(place, from.size(), to);
  try {
    post->Read(files, plan.arm, settings);
    return {};
  } catch (const InputError& error) {
    return error.problems();
  }
}

int LineOf(const std::string& controller, const std::string& part) {
  const auto post = MakePost(controller);
  const PlanResult plan = SamplePlan();
  const std::string text =
      post->Write(MakeMotionProgram(plan), plan.arm, SampleSettings(controller)).rbegin()->second;
  return 1 +
         static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(text.find(part)), '\n'));
}

TEST(ReaderErrors, KrlNamesLineAndColumn) {
  auto problems = ProblemsWith("krl", "LIN {X ", "LIN {X 1,");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].place.line, LineOf("krl", "LIN {X "));
  EXPECT_EQ(problems[0].place.column, 10);
  EXPECT_NE(problems[0].message.find("one of the fields X, Y, Z"), std::string::npos) << problems[0].message;

  EXPECT_EQ(ProblemsWith("krl", "C_DIS", "C_DUS").size(), 1u);
  EXPECT_EQ(ProblemsWith("krl", "\nEND\n", "\n").size(), 1u);
  EXPECT_EQ(ProblemsWith("krl", "\nEND\n", "\nEND\nLIN {X 1}\n").size(), 1u);
  EXPECT_EQ(ProblemsWith("krl", "$ORI_TYPE = #VAR", "$ORI_TYPE = #CONSTANT").size(), 1u);
  EXPECT_EQ(ProblemsWith("krl", "S 'B", "S 'C").size(),
            2u);  // and the next target lacks what it does not name
  EXPECT_EQ(ProblemsWith("krl", "$ADVANCE", "$ADVENCE").size(), 2u);  // and $ADVANCE is missing
  EXPECT_EQ(ProblemsWith("krl", "; job", "; the usual job").size(), 0u);
}

TEST(ReaderErrors, SaysWhatWasGivenWhereItStands) {
  struct Case {
    const char *controller, *text, *with, *given, *hint;
  };
  for (const auto& [controller, text, with, given, hint] : {
           Case{"krl", "LIN {X", "LINN {X", "'LINN'", "did you mean LIN?"},
           Case{"krl", "$VEL.CP", "$VEL.PC", "'$VEL.PC'", "did you mean $VEL.CP?"},
           Case{"krl", "LIN {X", "$OUT[7]=TRUE\nLIN {X", "'$OUT'", "outputs: the cell's texts"},
           Case{"krl", "$VEL.CP = ", "$VEL.CP = -", "'-0.", "a number above 0"},
           Case{"sinumerik", "\nG1 X", "\nG91 G1 X", "'G91'", "G90"},
           Case{"sinumerik", "\nG1 X", "\nM8\nG1 X", "'M8'", "coolant: the cell's texts"},
           Case{"sinumerik", "\nG1 X", "\nSTOPRE\nG1 X", "'STOPRE'", "a word of a milling program"},
           Case{"linuxcnc", "\nG1 X", "\nG2 X", "'G2'", "G1"},
           Case{"linuxcnc", "\nG1 X", "\nM8\nG1 X", "'M8'", "coolant: the cell's texts"},
       }) {
    const std::vector<Problem> problems = ProblemsWith(controller, text, with);
    ASSERT_GE(problems.size(), 1u) << with;
    EXPECT_NE(problems[0].message.find(std::string(", but ") + given), std::string::npos)
        << problems[0].message;
    EXPECT_NE(problems[0].message.find(hint), std::string::npos) << problems[0].message;
    EXPECT_GT(problems[0].place.line, 1);
    EXPECT_EQ(problems[0].place.column, with[0] == '$' && given[1] == '-' ? 11 : 1) << problems[0].message;
  }
}

TEST(ReaderErrors, AllProblemsAtOnce) {
  const auto post = MakePost("krl");
  const std::string text =
      "DEF A ( )\nBAS (#INITMOV,0 )\nBAS (#VEL_PTP,30 )\n$ADVANCE = 3\nLIN {Q 1}\nPTP {A1 2}\nFOO\nHALT\nLIN "
      "{X 1}\nEND\n";
  try {
    post->Read({{"a.src", text}}, SampleArm(), SampleSettings("krl"));
    FAIL();
  } catch (const InputError& error) {
    std::set<int> lines;
    for (const Problem& problem : error.problems()) lines.insert(problem.place.line);
    EXPECT_EQ(lines, (std::set<int>{5, 6, 7, 9}));  // 5 lacks settings too; their order is the file's
    EXPECT_TRUE(std::ranges::is_sorted(error.problems(), {}, [](const Problem& p) { return p.place.line; }));
  }
}

TEST(ReaderErrors, SinumerikNamesTheLine) {
  EXPECT_EQ(ProblemsWith("sinumerik", "ORIWKS", "ORIMKS").size(), 2u);  // and ORIWKS, with all of its block
  EXPECT_EQ(ProblemsWith("sinumerik", " PTP", "").size(), 1u);          // G0 without PTP: an undefined path
  EXPECT_EQ(ProblemsWith("sinumerik", "M30", "M17").size(), 2u);
  EXPECT_EQ(ProblemsWith("sinumerik", "RA1=", "RA1").size(), 1u);
  EXPECT_EQ(ProblemsWith("sinumerik", "T=\"SPINDLE_D20", "T=\"SPINDLE_D10").size(), 2u);
  EXPECT_EQ(ProblemsWith("sinumerik", "CROT", "CROTS").size(), 3u);
}

TEST(ReaderErrors, LinuxCncNamesTheLine) {
  EXPECT_EQ(ProblemsWith("linuxcnc", "G93", "G92").size(), 1u);
  EXPECT_EQ(ProblemsWith("linuxcnc", "M2\n", "").size(), 1u);
  EXPECT_EQ(ProblemsWith("linuxcnc", "G1 X", "G1 Y").size(), 1u);
  EXPECT_EQ(ProblemsWith("linuxcnc", "G1 X", "G1 X,").size(), 1u);
}

/// What ran before a program must not decide where it goes.
TEST(ReaderErrors, SettingsAreStatedBeforeTheFirstMotion) {
  struct Case {
    const char *controller, *text, *without, *name;
  };
  for (const auto& [controller, text, without, name] : {
           Case{"krl", "    BAS (#INITMOV,0 )\n", "", "BAS (#INITMOV,0 )"},
           Case{"krl", "BAS (#VEL_PTP,30 )\n", "", "BAS (#VEL_PTP,…)"},
           Case{"sinumerik", "G17 G710", "G17", "G710"},
           Case{"linuxcnc", "G59.3 ", "", "G59.3"},
           Case{"linuxcnc", "G21 G90", "G21", "G90"},
           Case{"linuxcnc", "G10 L2 P9 X0 Y0 Z0 A0 B0 C0 R0", "", "G10 L2 P9 X0 Y0 Z0 A0 B0 C0 R0"},
       }) {
    const std::vector<Problem> problems = ProblemsWith(controller, text, without);
    ASSERT_EQ(problems.size(), 1u) << controller << " without " << name;
    EXPECT_EQ(problems[0].message, fmt::format("{} must be stated before the first motion", name));
    EXPECT_GT(problems[0].place.line, 1);
  }
}

TEST(ReaderErrors, RoundingHasABound) {
  EXPECT_EQ(ProblemsWith("krl", "VEL_PTP,30", "VEL_PTP,31").size(), 1u);
  EXPECT_EQ(ProblemsWith("krl", "VEL_PTP,30", "VEL_PTP,10").size(), 0u);
  EXPECT_FALSE(ProblemsWith("sinumerik", "_FINISH", "_OFF").empty());
  EXPECT_EQ(ProblemsWith("linuxcnc", " Q0", "").size(), 1u);
  EXPECT_EQ(ProblemsWith("linuxcnc", "G64 P", "G64 Q0 ; P").size(), 1u);
  EXPECT_EQ(ProblemsWith("linuxcnc", "G64 P", "G64 P0 Q").size(), 1u);
}

}  // namespace
}  // namespace millpose
