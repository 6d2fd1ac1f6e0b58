// SPDX-License-Identifier: GPL-3.0-or-later
// All that a program does beside its motions is held against the plan: in order, count, place and arguments.
#include <gtest/gtest.h>

#include "tests/program/verify/plant_program.hpp"

namespace millpose {
namespace {

class Events : public testing::TestWithParam<std::string> {
 protected:
  PlantProgram program{GetParam()};

  size_t Mark(bool begin, int pass) const { return program.Find(program.Mark(begin, pass)); }
  /// It is refused, at this line (from 0) and in these words where it is no error of reading.
  void ExpectSaid(size_t line, const std::string& words) const {
    const std::string said = program.AgainstThePlan();
    EXPECT_NE(said.find(fmt::format("{}: ", line + 1)), std::string::npos) << said;
    EXPECT_NE(said.find(words), std::string::npos) << said;
  }
};
INSTANTIATE_TEST_SUITE_P(Controllers, Events, testing::Values("krl", "sinumerik", "linuxcnc"),
                         [](const auto& controller) { return controller.param; });

TEST_P(Events, AsWrittenAreAsPlanned) { EXPECT_EQ(program.AgainstThePlan(), ""); }

TEST_P(Events, ACallThatThePlanDoesNotHaveIsAnError) {
  struct Case {
    const char* call;
    int argument;
    const char* behind;
  };
  for (const auto& [call, argument, behind] :
       {Case{"SPINDLE_OFF", 0, "SPINDLE_ON"}, Case{"TOOL_CHANGE", 3, "TOOL_CHANGE"},
        Case{"SUCTION", 0, "SPINDLE_ON"}, Case{"LIGHT", 1, "TOOL_CHANGE"}}) {
    PlantProgram edited(GetParam());
    const size_t at = edited.Find(behind) + 1;
    edited.Insert(at, edited.Call(call, argument));
    const std::string said = edited.AgainstThePlan();
    EXPECT_NE(said, "") << call;
    // The spindle's own text is that of a switch, wherever it stands.
    const bool switches = std::string(call) == "SPINDLE_OFF";
    const std::string words = switches
                                  ? "the spindle switched off is not planned here"
                                  : fmt::format("the call of {}({}) is not planned here", call, argument);
    EXPECT_NE(said.find(fmt::format("{}: {}", at + 1, words)), std::string::npos) << said;
  }
}

TEST_P(Events, PassTextsAreHeldWithTheirMarks) {
  const PlantProgram written(GetParam());
  // One deleted with its mark.
  program.Erase(Mark(true, 1));
  program.Erase(program.Find(program.Call("SUCTION", 1)));
  EXPECT_NE(program.AgainstThePlan().find("the mark of the begin of pass 1 piece 0 is missing here"),
            std::string::npos)
      << program.AgainstThePlan();
  // All of them.
  for (const int pass : {0, 2}) {
    program.Erase(Mark(true, pass));
    program.Erase(program.Find(program.Call("SUCTION", pass)));
  }
  EXPECT_NE(program.AgainstThePlan(), "");
  // One moved into the pass before.
  program.lines = written.lines;
  program.Erase(program.Find(program.Call("SUCTION", 1)));
  const size_t mark = Mark(true, 1);
  program.Erase(mark);
  const size_t end = Mark(false, 0);
  program.Insert(end, program.Mark(true, 1));
  program.Insert(end + 1, program.Call("SUCTION", 1));
  EXPECT_NE(program.AgainstThePlan(), "");
}

TEST_P(Events, StopsAndDwellsAreThePlans) {
  const std::string way = GetParam() == "krl" ? "PTP {A1" : GetParam() == "sinumerik" ? "G0 SUPA" : "G0 X";
  const size_t at = program.Find(way, 1);
  program.Insert(at, program.Stop());
  ExpectSaid(at, fmt::format("the stop {} is not planned here", program.Stop()));
  program.lines[at] = program.Dwell();
  ExpectSaid(at, "a dwell of 0.5 s is not planned here");
  if (GetParam() == "krl") {
    program.lines[at] = "WAIT FOR $IN[3]";
    ExpectSaid(at, "$IN[3] is not planned here");
    return;
  }
  program.lines[at] = GetParam() == "sinumerik" ? "MSG(\"go on\")" : "(MSG, go on)";
  ExpectSaid(at, "GO ON\" is not planned here");
}

TEST_P(Events, ATextInAnotherPlaceIsAnError) {
  const size_t off = program.Find(program.Call("SPINDLE_OFF", 0));
  const std::string text = program.lines[off];
  program.Erase(off);
  program.Insert(program.Find(program.Mark(false, 1)) + 1, text);
  EXPECT_NE(program.AgainstThePlan(), "");
}

TEST_P(Events, WhatHarmsNothingPasses) {
  const size_t call = program.Find(program.Call("SUCTION", 1));
  for (const std::string& same :
       GetParam() == "krl" ? std::vector<std::string>{"suction  ( 1 )", "SUCTION(1) ; on"}
       : GetParam() == "sinumerik"
           ? std::vector<std::string>{"suction( 1 )", "N10 SUCTION(1) ; on"}
           : std::vector<std::string>{"o<suction> call [ 1 ]", "O<SUCTION> CALL [1] ; on"}) {
    program.lines[call] = same;
    EXPECT_EQ(program.AgainstThePlan(), "") << same;
  }
  program.Insert(call + 1, "; checked");
  program.Insert(call + 1, "");
  EXPECT_EQ(program.AgainstThePlan(), "");
}

}  // namespace
}  // namespace millpose
