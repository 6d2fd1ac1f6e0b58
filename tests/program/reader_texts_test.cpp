// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of a cell go through the reader like any other line; declared calls leave everything unknown.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

std::vector<Problem> TextProblems(const std::string& variant, const std::string& name,
                                  const std::string& text, std::vector<DeclaredCall> calls = {}) {
  PostSettings settings = SampleSettings(variant);
  settings.texts = {{name, text}};
  settings.calls = std::move(calls);
  return SamplePost(variant)->CheckTexts(SampleArm(), settings);
}

TEST(CellTexts, WhatNoReaderModelsIsRefused) {
  struct Case {
    const char *controller, *text;
    int line;
  };
  for (const auto& [controller, text, line] : {
           Case{"krl", "PTP {A1 0,A2 -90,A3 90,A4 0,A5 0,A6 0}\nLIN_REL {Z -500}", 2},
           Case{"krl", "$OUT[1]=TRUE\nMOVE_ASIDE ( )", 2},
           Case{"krl", "$OV_APPL = 10", 1},
           Case{"krl", "$BASE = BASE_DATA[3]", 1},
           Case{"krl", "$OUT[0]=TRUE", 1},
           Case{"krl", "WAIT FOR MOVE_ASIDE()", 1},
           Case{"krl", "GOTO PASS_0_0", 1},
           Case{"krl", "; a remark\n\nLIN_REL {Z -500}", 3},
           Case{"sinumerik", "M5\nSUPA G0 Z0", 2},
           Case{"sinumerik", "L100", 1},
           Case{"sinumerik", "TRANS X10", 1},
           Case{"linuxcnc", "M5\nG53 G0 Z0", 2},
           Case{"linuxcnc", "O<move_aside> CALL", 1},
           Case{"linuxcnc", "M101", 1},
           Case{"linuxcnc", "G92 X0", 1},
       }) {
    const std::vector<Problem> problems = TextProblems(controller, "pass_begin", text);
    ASSERT_FALSE(problems.empty()) << controller << ": " << text;
    EXPECT_EQ(problems[0].place.file, "pass_begin");
    EXPECT_EQ(problems[0].place.line, line) << text;
  }
}

TEST(CellTexts, WordsThatSwitchAreRead) {
  struct Case {
    const char *controller, *text;
  };
  for (const auto& [controller, text] : {
           Case{"krl",
                "; start the spindle\n$ANOUT[1]={rpm}/7000\n$OUT[1]=TRUE\nWAIT FOR $IN[2]\nWAIT SEC 1\nHALT"},
           Case{"krl", "PULSE($OUT[4],TRUE,0.5)"},
           Case{"krl", "$VEL.CP = 0.1\n$APO.CDIS = 0.02"},  // modelled: replayed
           Case{"sinumerik", "S{rpm} M3\nM8\n$A_OUT[3]=1\nG4 F2\nMSG(\"piece {piece} of pass {pass}\")"},
           Case{"sinumerik", "T=\"{tool}\" D1\nM6"},
           Case{"linuxcnc", "S{rpm} M3\nM8\nM64 P3\nM66 P0 L3 Q5\nG4 P2\n(pass {pass})"},
           Case{"linuxcnc", "M68 E3 Q0\nM66 E0 L0"},
       }) {
    const std::vector<Problem> problems = TextProblems(controller, "pass_begin", text);
    EXPECT_TRUE(problems.empty()) << text << ": " << problems[0].message;
  }
}

TEST(CellTexts, DeclaredCallsAreRead) {
  struct Case {
    const char *controller, *text, *name;
  };
  for (const auto& [controller, text, name] :
       {Case{"krl", "SPINDLE_ON ({rpm},#FAST,\"x\")", "spindle_on"},
        Case{"krl", "SPINDLE_ON()", "SPINDLE_ON"}, Case{"sinumerik", "SPINDLE_ON({rpm})", "SPINDLE_ON"},
        Case{"sinumerik", "spindle_on", "SPINDLE_ON"},
        Case{"linuxcnc", "O<spindle_on> CALL [{rpm}]", "spindle_on"}, Case{"linuxcnc", "M101", "M101"}}) {
    EXPECT_FALSE(TextProblems(controller, "pass_begin", text).empty()) << text;
    const std::vector<Problem> problems =
        TextProblems(controller, "pass_begin", text, {{name, false, {}, {}}});
    EXPECT_TRUE(problems.empty()) << text << ": " << problems[0].message;
  }
}

/// A text is read where its event is, not wherever its lines happen to stand.
TEST(CellTexts, StandAtTheirPlace) {
  PostSettings settings = SampleSettings("krl");
  settings.texts["pass_begin"] = "$OUT[7]=TRUE";
  settings.texts["footer"] = "$OUT[8]=FALSE";
  const PlanResult plan = SamplePlan();
  const auto post = MakePost("krl");
  const ProgramFiles written = post->Write(MakeMotionProgram(plan), plan.arm, settings);
  EXPECT_NO_THROW(post->Read(written, plan.arm, settings));
  for (const std::string line : {"$OUT[7]=TRUE\n", "$OUT[8]=FALSE\n", "$OUT[1]=FALSE\n"}) {
    ProgramFiles moved = written;
    std::string& text = moved.rbegin()->second;
    const size_t cut = text.find("C_DIS\n") + 6;
    text.insert(cut, line);
    EXPECT_THROW(post->Read(moved, plan.arm, settings), InputError) << line;
  }
}

/// What a call does is unknown: all that counts is stated again behind it.
TEST(CellTexts, CallsMakeSettingsUnknown) {
  const PlanResult plan = SamplePlan();
  for (const std::string variant : {"krl", "sinumerik", "linuxcnc", "linuxcnc_cartesian"}) {
    PostSettings settings = SampleSettings(variant);
    const auto post = SamplePost(variant);
    const bool krl = variant == "krl", linuxcnc = ControllerOf(variant) == "linuxcnc";
    settings.calls = {{"WASH", false, {}, {}}};
    const std::string call = krl ? "WASH()" : linuxcnc ? "O<WASH> CALL" : "WASH";
    for (const std::string text : {"header", "pass_begin", "pass_end", "spindle_on", "footer"}) {
      settings.texts = SampleSettings(variant).texts;
      settings.texts[text] += (settings.texts[text].empty() ? "" : "\n") + call;
      const ProgramFiles files = post->Write(MakeMotionProgram(plan), plan.arm, settings);
      try {
        const MotionProgram read = post->Read(files, plan.arm, settings);
        ASSERT_EQ(read.calls.size(), 1u) << variant << " " << text;
        EXPECT_EQ(read.calls[0].name, "WASH");
      } catch (const InputError& error) {
        ADD_FAILURE() << variant << " " << text << ": " << error.what();
      }
    }
    // In a cut, or without what follows it, the program is not read.
    ProgramFiles files = post->Write(MakeMotionProgram(plan), plan.arm, settings);
    std::string& text = files.rbegin()->second;
    const char* last = krl ? "C_DIS\n" : "\nG1 ";
    const size_t cut = text.rfind(last) + (krl ? 6 : 1);
    text.insert(cut, call + "\n");
    EXPECT_THROW(post->Read(files, plan.arm, settings), InputError) << variant;
  }
}

}  // namespace
}  // namespace millpose
