// SPDX-License-Identifier: GPL-3.0-or-later
// Statements that are harmless at one place and wrong at another; every case here was once confirmed.
#include <gtest/gtest.h>

#include <regex>

#include "tests/program/program_lines.hpp"

namespace millpose {
namespace {

testing::AssertionResult RefusedAt(const ProgramLines& sample, size_t index) {
  const std::vector<Problem> problems = sample.Problems();
  for (const Problem& problem : problems) {
    if (problem.place.line == static_cast<int>(index) + 1) return testing::AssertionSuccess();
  }
  return testing::AssertionFailure() << "line " << index + 1 << " '" << sample.lines[index]
                                     << "': " << (problems.empty() ? "read" : problems[0].message);
}

/// `statement` put before the nth line that matches `pattern` is refused with its line.
testing::AssertionResult RefusedBefore(const std::string& variant, const std::string& pattern, int nth,
                                       const std::string& statement) {
  ProgramLines sample(variant);
  const size_t at = sample.Find(pattern, nth);
  sample.Insert(at, statement);
  return RefusedAt(sample, at);
}

testing::AssertionResult ReadBefore(const std::string& variant, const std::string& pattern, int nth,
                                    const std::string& statement) {
  ProgramLines sample(variant);
  sample.Insert(sample.Find(pattern, nth), statement);
  const std::vector<Problem> problems = sample.Problems();
  if (problems.empty()) return testing::AssertionSuccess();
  return testing::AssertionFailure() << statement << ": " << problems[0].message;
}

constexpr const char* kKrlCut = "^LIN .*C_DIS";
constexpr const char* kKrlEntry = "^PTP .*,S ";

TEST(ReaderPlaces, NoPauseInAKrlCut) {
  for (const std::string pause : {"HALT", "WAIT SEC 0.5", "WAIT FOR $IN[3]"}) {
    EXPECT_TRUE(RefusedBefore("krl", kKrlCut, 2, pause));
    // Behind the stop of the approach: a dwell may stand there as far as a reader can tell, see
    // CompareDwells.
    const bool dwell = pause.starts_with("WAIT SEC");
    EXPECT_TRUE(dwell ? ReadBefore("krl", kKrlCut, 0, pause) : RefusedBefore("krl", kKrlCut, 0, pause));
    EXPECT_TRUE(ReadBefore("krl", kKrlEntry, 1, pause));     // before the entry of a piece
    EXPECT_TRUE(ReadBefore("krl", "^PTP \\{A1", 1, pause));  // in a way
  }
  EXPECT_TRUE(RefusedBefore("krl", kKrlEntry, 1, "WAIT SEC -1"));
  EXPECT_TRUE(RefusedBefore("krl", kKrlEntry, 1, "WAIT FOR MOVE_ASIDE()"));
  EXPECT_TRUE(RefusedBefore("krl", kKrlEntry, 1, "WAIT FOR"));
  EXPECT_TRUE(ReadBefore("krl", kKrlEntry, 1, "WAIT FOR $IN[3]==TRUE AND NOT ($IN[4] OR $FLAG[1])"));
}

TEST(ReaderPlaces, KrlSettingsStayOutOfCuts) {
  for (const std::string setting :
       {"$APO.CDIS = 0", "$APO.CDIS = -0.02", "$VEL.ORI1 = 100", "$VEL.ORI2 = 100", "$ADVANCE = 3",
        "$ORI_TYPE = #VAR", "BAS (#VEL_PTP,20 )", "INTERRUPT ON 3"}) {
    EXPECT_TRUE(RefusedBefore("krl", kKrlCut, 2, setting));
  }
  EXPECT_TRUE(ReadBefore("krl", kKrlCut, 2, "$VEL.CP = 0.00133333"));  // a feed is allowed
  EXPECT_TRUE(ReadBefore("krl", kKrlCut, 2, "$APO.CDIS = 0.02"));      // and so is another rounding
  EXPECT_TRUE(ReadBefore("krl", kKrlEntry, 1, "$APO.CDIS = 0.02"));
  EXPECT_TRUE(RefusedBefore("krl", kKrlEntry, 1, "INTERRUPT ON 3"));
}

TEST(ReaderPlaces, KrlDefaultsMakeSettingsUnknown) {
  // Anywhere but at the head: what comes behind is an error until all is set again.
  for (const char* place : {kKrlEntry, "^PTP \\{A1", kKrlCut}) {
    ProgramLines sample("krl");
    const size_t at = sample.Find(place, 1);
    sample.Insert(at, "BAS (#INITMOV,0 )");
    EXPECT_TRUE(RefusedAt(sample, at + 1)) << place;
  }
  ProgramLines late("krl");  // the speed before the defaults is lost
  const size_t speed = late.Find("VEL_PTP"), defaults = late.Find("INITMOV");
  std::rotate(late.lines.begin() + static_cast<long>(defaults), late.lines.begin() + static_cast<long>(speed),
              late.lines.begin() + static_cast<long>(speed) + 1);
  EXPECT_TRUE(RefusedAt(late, late.Find("^PTP")));
  ProgramLines again("krl");  // behind it all is stated again
  const size_t at = again.Find(kKrlEntry, 1);
  for (const char* setting : {"INITMOV", "\\$BASE", "\\$TOOL", "\\$ADVANCE", "\\$APO", "VEL_PTP",
                              "\\$ORI_TYPE", "VEL.ORI1", "VEL.ORI2"})
    again.Insert(at, again.lines[again.Find(setting)]);
  std::rotate(again.lines.begin() + static_cast<long>(at), again.lines.begin() + static_cast<long>(at) + 8,
              again.lines.begin() + static_cast<long>(at) + 9);
  again.Insert(at + 9, "$VEL.CP = 0.00133333");
  const auto problems = again.Problems();
  EXPECT_TRUE(problems.empty()) << problems[0].message;
}

TEST(ReaderPlaces, KrlSettingsThatStopTheArm) {
  const auto refused = [](const std::string& setting, const std::string& with) {
    ProgramLines sample("krl");
    const size_t at = sample.Find(setting);
    sample.lines[at] = with;
    return RefusedAt(sample, at);
  };
  EXPECT_TRUE(refused("\\$ADVANCE", "$ADVANCE = 0"));
  EXPECT_TRUE(refused("\\$APO.CDIS", "$APO.CDIS = 0"));
  EXPECT_TRUE(refused("\\$APO.CDIS", "$APO.CDIS = -1"));
  EXPECT_TRUE(refused("INITMOV", "BAS (#INITMOV,1 )"));
  EXPECT_TRUE(refused("VEL_PTP", "BAS (#VEL_PTP,0.001 )"));
  EXPECT_TRUE(RefusedBefore("krl", "^PTP", 0, "$ACC.CP = 0.00001"));  // the cell says nothing of it
}

TEST(ReaderPlaces, KrlNames) {
  ProgramLines twice("krl");
  const size_t label = twice.Find("^PASS_0_0:");
  twice.Insert(label + 3, "pass_0_0:");
  EXPECT_TRUE(RefusedAt(twice, label + 3));
  for (const char* line : {kKrlCut, "^\\$OUT\\[1\\]=TRUE", "^\\$VEL.CP"}) {  // KRL has no block numbers
    ProgramLines numbered("krl");
    const size_t at = numbered.Find(line);
    numbered.lines[at] = "N10 " + numbered.lines[at];
    EXPECT_FALSE(numbered.Problems().empty()) << line;
  }
  ProgramLines header("krl");
  header.Insert(header.Find("^PTP"), "&REL 2");
  EXPECT_FALSE(header.Problems().empty());
  ProgramLines both("krl");
  const size_t target = both.Find("^PTP \\{A1");
  both.lines[target].insert(both.lines[target].size() - 1, ",X 1000");
  EXPECT_TRUE(RefusedAt(both, target));
}

TEST(ReaderPlaces, KrlSpelling) {
  const auto problems = [](const std::string& line, const std::string& from, const std::string& to) {
    ProgramLines sample("krl");
    const size_t at = sample.Find(line);
    const std::string before = sample.lines[at];
    sample.lines[at] = std::regex_replace(before, std::regex(from), to);
    EXPECT_NE(sample.lines[at], before) << line;
    return sample.Problems().size();
  };
  EXPECT_EQ(problems("^&REL", "^&", " &"), 1u);
  // And the next target lacks what it does not name.
  EXPECT_EQ(problems(kKrlEntry, "T 'B[01]+'", "T 10.5"), 2u);
  EXPECT_EQ(problems(kKrlEntry, "T 'B[01]+'", "T 64"), 2u);
  EXPECT_EQ(problems("^\\$OUT\\[1\\]=TRUE", "$", " ; checked"), 0u);
  EXPECT_EQ(problems("^\\$OUT\\[1\\]=TRUE", "=", " = "), 0u);
  EXPECT_GE(problems("^\\$OUT\\[1\\]=TRUE", "TRUE", "TR UE"), 1u);
  EXPECT_EQ(problems("^BAS \\(#VEL", "BAS ", "BAS  "), 0u);
  EXPECT_TRUE(ReadBefore("krl", kKrlEntry, 1, "WAIT  SEC 1"));
  EXPECT_TRUE(RefusedBefore("krl", kKrlEntry, 1, "WAITSEC 1"));
}

TEST(ReaderPlaces, NoRoundingThatNobodyPlanned) {
  for (const char* word : {" C_VEL", " C_SPL", " C_ORI", " C_PTP C_DIS"}) {
    for (const char* line : {"^LIN .*C_DIS", "^PTP \\{A1", kKrlEntry}) {
      ProgramLines sample("krl");
      const size_t at = sample.Find(line, 1);
      sample.lines[at] = std::regex_replace(sample.lines[at], std::regex(" C_DIS"), "") + word;
      EXPECT_TRUE(RefusedAt(sample, at)) << word;
    }
  }
}

TEST(ReaderPlaces, NoSplineBlocks) {
  EXPECT_TRUE(RefusedBefore("krl", kKrlCut, 2, "SPLINE"));
  EXPECT_TRUE(RefusedBefore("krl", kKrlCut, 2, "ENDSPLINE"));
}

}  // namespace
}  // namespace millpose
