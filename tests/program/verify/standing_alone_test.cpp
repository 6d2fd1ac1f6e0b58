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

  std::string Cut() const { return GetParam() == "krl" ? "LIN " : "G1 "; }
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
       {size_t{1}, size_t{2}, size_t{3}}) {  // in the cut, at its end, behind the retract
    PlantProgram cut(GetParam());
    cut.lines.resize(end - before + 1);
    cut.lines.push_back(End());
    EXPECT_NE(cut.Alone().find("does not end"), std::string::npos) << cut.Alone();
  }
}

TEST_P(Alone, ACutRunsNoFasterThanTheHeaderStates) {
  if (GetParam() == "krl") {
    program.Insert(program.Find("LIN ", 3), "$VEL.CP = 0.05");
  } else {
    const size_t cut = program.Find(Cut(), GetParam() == "sinumerik" ? 3 : 20);
    if (GetParam() == "sinumerik")
      program.lines[cut] += " F3000";
    else
      Replace(program.Find(" F", 20), "F([0-9.]+)", "F$010");
  }
  const std::string said = program.Alone();
  EXPECT_NE(said.find("mm/min at most in cuts"), std::string::npos) << said;
}

TEST_P(Alone, WithoutAHeaderTheScopeSaysSo) {
  std::erase_if(program.lines, [](const std::string& line) {
    return line.starts_with("; spindle:") || line.starts_with("; feed:");
  });
  EXPECT_EQ(program.Alone(), "");
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
