// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of a program without its plan: edits that no milling program survives.
#include <gtest/gtest.h>

#include <regex>

#include "tests/program/verify/plant_program.hpp"

namespace millpose {
namespace {

class Alone : public testing::TestWithParam<std::string> {
 protected:
  PlantProgram program{GetParam()};

  std::string End() const { return GetParam() == "krl" ? "END" : GetParam() == "sinumerik" ? "M30" : "M2"; }
  void ExpectSaid(const std::string& words) const {
    const std::string said = program.Alone();
    EXPECT_NE(said.find(words), std::string::npos) << "'" << said << "'";
  }
  void Replace(size_t line, const std::string& from, const std::string& to) {
    const std::string before = program.lines[line];
    program.lines[line] = std::regex_replace(before, std::regex(from), to);
    EXPECT_NE(program.lines[line], before);
  }
};
INSTANTIATE_TEST_SUITE_P(Controllers, Alone, testing::Values("krl", "sinumerik", "linuxcnc"),
                         [](const auto& controller) { return controller.param; });

TEST_P(Alone, AsWrittenIsConfirmed) { EXPECT_EQ(program.Alone(), ""); }

TEST_P(Alone, TheSpindleTurnsInEveryCut) {
  const size_t on = program.Find("SPINDLE_ON");
  program.Erase(on);
  ExpectSaid("the spindle stands still in a cut");
}

TEST_P(Alone, TheSpindleIsNotSwitchedOffBehindBeingSwitchedOn) {
  program.Insert(program.Find("SPINDLE_ON") + 1, program.Call("SPINDLE_OFF", 0));
  ExpectSaid("the spindle stands still in a cut");
}

TEST_P(Alone, TheSpindleStandsAtTheEnd) {
  program.Erase(program.Find(program.Call("SPINDLE_OFF", 0)));
  ExpectSaid("the spindle turns at the end");
}

TEST_P(Alone, TheSpindleTurnsAsTheHeaderStates) {
  Replace(program.Find("SPINDLE_ON"), "7000", "70");
  ExpectSaid("switched on at 70.000 1/min; the header states 7000.000 1/min");
}

TEST_P(Alone, CallsOfTheCellsTextsStandInThem) {
  program.Insert(program.Find("TOOL_CHANGE") + 1, program.Call("TOOL_CHANGE", 3));
  ExpectSaid("the call of TOOL_CHANGE(3) stands outside the cell's text tool_change");
}

TEST_P(Alone, NoProgramEndsInACut) {
  const size_t end = program.Find(program.Mark(false, 1));
  for (const size_t before :
       {size_t{1}, size_t{2}, size_t{3}}) {  // behind the retract, at the end of the cut, in it
    PlantProgram cut(GetParam());
    cut.lines.resize(end - before + 1);
    cut.lines.push_back(End());
    EXPECT_NE(cut.Alone().find("does not end"), std::string::npos) << cut.Alone();
  }
}

TEST_P(Alone, ACutRunsNoFasterThanTheHeaderStates) {
  if (GetParam() == "krl") {
    program.Insert(program.Find("LIN ", 3), "$VEL.CP = 0.05");
  } else if (GetParam() == "sinumerik") {
    program.lines[program.Find("G1 ", 3)] += " F3000";
  } else {
    size_t cut = program.Find("M62 P5");  // where the cut begins
    while (!program.lines[cut].starts_with("G1 ")) ++cut;
    std::string& line = program.lines[cut];
    const size_t feed = line.find(" F");
    ASSERT_NE(feed, std::string::npos) << line;
    line = fmt::format("{} F{:.6f}", line.substr(0, feed), 30 * std::stod(line.substr(feed + 2)));
  }
  const std::string said = program.Alone();
  EXPECT_NE(said.find("mm/min at most in cuts"), std::string::npos) << said;
}

TEST_P(Alone, WithoutAHeaderTheScopeSaysSo) {
  std::erase_if(program.lines, [](const std::string& line) {
    return line.starts_with("; spindle:") || line.starts_with("; feed:");
  });
  EXPECT_EQ(program.Alone(), "");
  EXPECT_NE(program.Scope().find("; the header states no spindle speed; the header states no feeds"),
            std::string::npos)
      << program.Scope();
}

TEST_P(Alone, ACellThatDoesNotSwitchTheSpindleIsNamed) {
  const PlantProgram without(GetParam(), false);
  EXPECT_EQ(without.AgainstThePlan(), "");
  EXPECT_EQ(without.Alone(), "");
  EXPECT_NE(without.Scope().find("; the cell has no text that switches the spindle"), std::string::npos);
}

TEST_P(Alone, ADryRunMayRunWithTheSpindleStanding) {
  program.Erase(program.Find("SPINDLE_ON"));
  program.Insert(program.Find("; spindle:"), "; dry_run: cuts are lifted by 25.000 mm along the tool axis");
  EXPECT_EQ(program.Alone().find("the spindle stands still"), std::string::npos) << program.Alone();
  EXPECT_NE(program.Scope().find("a dry run: the spindle may stand still"), std::string::npos);
}

TEST(AloneKrl, TheFrameIsChecked) {
  PlantProgram program("krl");
  const size_t first = program.Find("MP_OFF = "),
               last = program.Find("BAS (#INITMOV") > first ? 0 : program.Find("$BASE");
  ASSERT_GT(last, first);
  program.lines.erase(program.lines.begin() + static_cast<long>(first),
                      program.lines.begin() + static_cast<long>(last));
  EXPECT_NE(program.Alone().find("the check of $ROBROOT is missing"), std::string::npos) << program.Alone();
}

}  // namespace
}  // namespace millpose
