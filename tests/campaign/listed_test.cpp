// SPDX-License-Identifier: GPL-3.0-or-later
// Edits that were once confirmed although they change what the machine does, and the other way round. The
// interpreters say which is which; reading and verifying must agree.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <regex>

#include "tests/campaign/bed.hpp"
#include "tests/campaign/runner.hpp"

namespace millpose::campaign {
namespace {

/// `text` before the nth line that matches; with `replace` in that line in place of what matches.
struct Edit {
  const char *variant, *line;
  int nth;
  std::string text;
  bool replace = false;
};

Files Edited(const Bed& bed, const Edit& edit) {
  Files files = bed.files();
  std::string& text = files.rbegin()->second;  // .src comes after .dat
  std::vector<std::string> lines = LinesOf(text);
  const std::regex regex(edit.line);
  int left = edit.nth;
  size_t at = 0;
  while (at < lines.size() && !(std::regex_search(lines[at], regex) && left-- == 0)) ++at;
  EXPECT_LT(at, lines.size()) << edit.line;
  if (at == lines.size()) return files;
  if (edit.replace)
    lines[at] = std::regex_replace(lines[at], regex, edit.text, std::regex_constants::format_first_only);
  else
    lines.insert(lines.begin() + static_cast<long>(at), edit.text);
  text.clear();
  for (size_t i = 0; i < lines.size(); ++i) text += lines[i] + (i + 1 < lines.size() ? "\n" : "");
  EXPECT_NE(text, bed.files().rbegin()->second) << edit.text;
  return files;
}

struct Outcome {
  Judgement judgement;
  Answer answer;
};

Outcome OutcomeOf(const Edit& edit) {
  const Bed bed(edit.variant);
  const Files files = Edited(bed, edit);
  return {Judge(bed.trace(), bed.Run(files), bed.machine()), bed.Ask(files)};
}

void ExpectCaught(const std::vector<Edit>& edits) {
  for (const Edit& edit : edits) {
    const Outcome outcome = OutcomeOf(edit);
    const std::string what = fmt::format("{}, {} {}: {}", edit.variant, edit.line, edit.nth, edit.text);
    EXPECT_GE(outcome.judgement.effect, Effect::kChanged) << what;
    EXPECT_FALSE(outcome.answer.accepted) << what << " (" << outcome.judgement.why << ")";
  }
}

const char *const kCut = "^LIN .*C_DIS", *const kEntry = "^PTP .*,S ", *const kWay = "^PTP \\{A1";

TEST(Listed, KrlEditsThatMatter) {
  std::vector<Edit> edits = {{"krl", "^\\$ADVANCE.*", 0, "$$ADVANCE = 0", true},
                             {"krl", "^\\$APO.CDIS.*", 0, "$$APO.CDIS = 0", true},
                             {"krl", "^\\$APO.CDIS.*", 0, "$$APO.CDIS = -0.01", true},
                             {"krl", "^BAS \\(#VEL_PTP,30", 0, "BAS (#VEL_PTP,100", true},
                             {"krl", "^BAS \\(#VEL_PTP.*", 0, "BAS (#INITMOV,0 )", true},
                             {"krl", "^\\$BASE", 0, "PASS_0_0:"},
                             {"krl", kCut, 1, "N10"},
                             {"krl", "^LIN", 2, "N10 LIN", true}};
  for (const char* word : {"C_VEL", "C_SPL", "C_ORI", "C_PTP"})
    edits.push_back({"krl", "C_DIS", 1, word, true});
  for (const char* place : {kWay, kEntry}) {
    edits.push_back({"krl", place, 1, "BAS (#INITMOV,0 )"});
    for (const char* word : {" C_PTP", " C_VEL", " C_DIS"}) {
      const std::string end = std::string(place) + ".*";
      edits.push_back({"krl", end.c_str(), 1, "$&" + std::string(word), true});
      ExpectCaught({edits.back()});
      edits.pop_back();
    }
  }
  for (const char* statement :
       {"BAS (#INITMOV,0 )", "HALT", "WAIT SEC 0.5", "WAIT FOR $IN[1]", "$ADVANCE = 0", "$APO.CDIS = 0",
        "SPLINE", "$BASE = $NULLFRAME", "$OUT[1]=FALSE", "GOTO PASS_0_0"})
    edits.push_back({"krl", kCut, 1, statement});
  ExpectCaught(edits);
}

TEST(Listed, SinumerikEditsThatMatter) {
  std::vector<Edit> edits = {{"sinumerik", "^G505 ORIRPY", 0, "ORIRPY", true},
                             {"sinumerik", "^T=\"SPINDLE_D20\" D1", 0, "T=\"SPINDLE_D20\" D2", true},
                             {"sinumerik", "^\\$P_UIFR\\[5\\]", 0, "$$P_UIFR[1]", true},
                             {"sinumerik", "^G1 X", 1, "G1 X1 X", true},
                             {"sinumerik", "^G1 X", 1, "G0 G1 X", true},
                             {"sinumerik", "^G1 X([-0-9.]+)", 1, "G1 X$1EX1", true},
                             {"sinumerik", "RA2=[-0-9.]+", 0, "RA2=1e308", true},
                             {"sinumerik", "^G1 X", 1, "G90 ;" + std::string(508, 'x')}};
  for (const char* statement : {"D0", "D2", "T=\"OTHER\"", "M6", "M0", "M1", "G4 F0.5", "TRAFOOF", "TRAORI",
                                "STOPRE", "G54", "G500", "M5", "G60"})
    edits.push_back({"sinumerik", "^G1 X", 3, statement});
  for (const char* statement : {"D0", "D2", "T=\"OTHER\"", "G91", "TRANS X1"})
    edits.push_back({"sinumerik", "^PASS_1_0:", 0, statement});
  ExpectCaught(edits);
}

TEST(Listed, LinuxCncEditsThatMatter) {
  std::vector<Edit> edits = {{"linuxcnc_cartesian", " Q0", 0, " Q0.5", true},
                             {"linuxcnc_cartesian", " Q0", 0, "", true},
                             {"linuxcnc_cartesian", "^G0 X5", 0, "G1 X5", true}};
  for (const char* variant : {"linuxcnc", "linuxcnc_cartesian"}) {
    for (const char* statement :
         {"(a) G0 X1 (b)", "(a) M5 (b)", "(a) G20 (b)", "M0", "M1", "G4 P0.5", "M5", "G91"})
      edits.push_back({variant, "^G1 X", 3, statement});
    edits.push_back({variant, "^G1 X", 3, "G90 ;" + std::string(252, 'x')});
  }
  ExpectCaught(edits);
}

TEST(Listed, WhatChangesNothingPasses) {
  std::vector<Edit> edits = {{"linuxcnc_cartesian", "^M66 E0 L0", 1, "m 66 e 0 L00", true},
                             {"krl", "^\\$OUT\\[1\\]=TRUE", 0, "$$OUT[1] = TRUE ; checked", true},
                             {"krl", "TRIGGER WHEN ", 0, "trigger  when ", true},
                             {"krl", "DISTANCE=0", 0, "DISTANCE=-0", true},
                             {"sinumerik", "^G1 X", 2, "G01 X", true},
                             {"sinumerik", "^T=", 0, "T = ", true},
                             {"krl", kCut, 1, "; a remark"}};
  for (const char* variant : {"linuxcnc", "linuxcnc_cartesian"}) {
    edits.push_back({variant, "^G1 X(.)", 2, "g 1 x $1", true});
    edits.push_back({variant, "^G61.1", 1, "G6 1.1", true});
    edits.push_back({variant, "^G61.1", 1, "G61.10005", true});
    for (const char* statement : {"G90", "G21", "(a) G90 (b)", "(here)", ""})
      edits.push_back({variant, "^G1 X", 3, statement});
  }
  for (const Edit& edit : edits) {
    const Outcome outcome = OutcomeOf(edit);
    const std::string what = fmt::format("{}, {} {}: {}", edit.variant, edit.line, edit.nth, edit.text);
    EXPECT_EQ(outcome.judgement.effect, Effect::kSame) << what << " (" << outcome.judgement.why << ")";
    EXPECT_TRUE(outcome.answer.accepted) << what << ": " << outcome.answer.why;
  }
}

/// The interpreter runs a program's check of $ROBROOT (KSS: frames one behind the other, ABS, IF, LOOP).
TEST(Listed, KrlStandsStillWhereTheFrameIsAnother) {
  const Bed bed("krl");
  Files files = bed.files();
  std::string& text = files.rbegin()->second;
  const auto insert = [&](const std::string& before, const std::string& lines) {
    const size_t at = text.find(before);
    ASSERT_NE(at, std::string::npos) << before;
    text.insert(at, lines);
  };
  insert("; written by", "DECL FRAME OFF\nDECL KRLMSGPAR_T PAR[3]\n");
  insert(
      "$BASE",
      "OFF = {FRAME: X 0.0,Y 0.0,Z 0.0,A 0.0,B 0.0,C 0.0}\nOFF = INV_POS(OFF):$ROBROOT\nPAR[1] = {PAR_TYPE "
      "#EMPTY}\nIF (ABS(OFF.X)>0.01) OR (ABS(OFF.Y)>0.01) OR (ABS(OFF.Z)>0.01) THEN\nLOOP\nHALT\nENDLOOP\n"
      "ENDIF\nIF (ABS(OFF.A)>0.001) OR (ABS(OFF.B)>0.001) OR (ABS(OFF.C)>0.001) THEN\nLOOP\nHALT\nENDLOOP\n"
      "ENDIF\n");
  const Trace checked = bed.Run(files);
  EXPECT_EQ(checked.refused, "");
  EXPECT_EQ(checked.guards, 4);
  EXPECT_EQ(Judge(bed.trace(), checked, bed.machine()).effect, Effect::kSame);
  for (const auto& [from, to] : {std::pair("(OFF.X)>0.01", "(OFF.X)>0.1"), std::pair("$ROBROOT", "OFF"),
                                 std::pair("(OFF.C)>0.001", "(OFF.B)>0.001")}) {
    Files changed = files;
    std::string& other = changed.rbegin()->second;
    other.replace(other.find(from), std::string(from).size(), to);
    EXPECT_EQ(Judge(checked, bed.Run(changed), bed.machine()).effect, Effect::kChanged) << to;
  }
}

TEST(Listed, APairOfPercentMayEncloseAProgram) {
  const Bed bed("linuxcnc");
  Files files = bed.files();
  std::string& text = files.begin()->second;
  text = "%\n" + text + "%\n";
  EXPECT_EQ(Judge(bed.trace(), bed.Run(files), bed.machine()).effect, Effect::kSame);
  EXPECT_TRUE(bed.Ask(files).accepted) << bed.Ask(files).why;
}

}  // namespace
}  // namespace millpose::campaign
