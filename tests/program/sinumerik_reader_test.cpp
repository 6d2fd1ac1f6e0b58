// SPDX-License-Identifier: GPL-3.0-or-later
// What the SINUMERIK reader allows where, and what it takes two blocks to mean.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/program/text_places.hpp"

namespace millpose {
namespace {

const std::string kCut = "\nG1 X", kLinkMove = "\nTRAFOOF\nG0 SUPA", kPiece = "\nPASS_1_0:";

class Sinumerik : public testing::Test {
 protected:
  TextPlaces sample{"sinumerik"};

  void Refuses(const std::string& line, const std::string& at, int nth, const std::string& hint) {
    sample.ExpectRefused(sample.Inserted(line, at, nth), line, hint);
  }
  void Takes(const std::string& line, const std::string& at, int nth) {
    EXPECT_EQ(sample.Problems(sample.Inserted(line, at, nth)), "") << line;
  }
  void RefusesChange(const std::string& from, const std::string& to, const std::string& hint) {
    sample.ExpectRefused(sample.Changed(from, to), to, hint);
  }
};

TEST_F(Sinumerik, ToolsAndEdgesBelongToTheHead) {
  for (const std::string line : {"D1", "M6", "T=\"SPINDLE_D20\"", "T=\"SPINDLE_D20\" D1"}) {
    Refuses(line, kCut, 3, "is not allowed in a cut");
    Refuses(line, kPiece, 0, "is not allowed");
  }
  Refuses("D0", kCut, 3, "D1 expected");
  Refuses("D2", kPiece, 0, "D1 expected");
  Refuses("T=\"SPINDLE_D10\"", kPiece, 0, "tool SPINDLE_D20 expected");
}

TEST_F(Sinumerik, NothingStopsOrTransformsInACut) {
  for (const std::string line : {"M0", "M1", "G4 F1", "TRAFOOF", "TRAORI", "CYCLE832(0.01,_ORI_FINISH,0.01)",
                                 "G505", "ORIWKS", "G642", "OTOL=0.01"})
    sample.ExpectRefused(sample.Inserted(line, kCut, 3), line, "");
  Refuses("STOPRE", kCut, 3, "a word of a milling program");
  for (const std::string line : {"M0", "M1", "G4 F1", "G4 F0.5"}) Takes(line, kLinkMove, 1);
  Refuses("G4 F1 X0", kLinkMove, 1, "");
}

TEST_F(Sinumerik, WhatChangesNothingMayStandAnywhere) {
  for (const std::string line : {"G90", "G94 G710", "N10 G40", "g17", "MSG(\"going\")", "LABEL:", "F80", ""})
    Takes(line, kCut, 3);
}

TEST_F(Sinumerik, TheFrameIsTheCellsAndSetBeforeItIsTaken) {
  Refuses("G54", kPiece, 0, "G505 expected");
  Refuses("G500", kPiece, 0, "G505 expected");
  Refuses("G505", "\n$P_UIFR", 0, "$P_UIFR[5] before G505 expected");
  Refuses("$P_UIFR[5]=CTRANS(X,0,Y,0,Z,0):CROT(X,0,Y,0,Z,0)", kPiece, 0, "one frame for all");
  RefusesChange("$P_UIFR[5]", "$P_UIFR[1]", "$P_UIFR[5] expected");
}

TEST_F(Sinumerik, EveryTraoriIsFollowedByWhatItTakesAway) {
  for (const std::string word : {"G505", "ORIRPY", "ORIVECT", "ORIWKS", "COMPOF", "G642"}) {
    std::string text = sample.text();
    const size_t second = text.find(word, text.find("\nTRAORI", text.find("\nTRAORI") + 1));
    text.erase(second, word.size());
    EXPECT_NE(sample.Problems(text).find(word + " between the last TRAORI and this motion expected"),
              std::string::npos)
        << word << ": " << sample.Problems(text);
  }
  RefusesChange("CYCLE832(0.0100,_ORI_FINISH,0.0100)\n", "", "tolerances of rounded corners");
  RefusesChange("_ORI_FINISH", "_FINISH", "_FINISH and OTOL=");
  EXPECT_EQ(sample.Problems(sample.Changed("_ORI_FINISH,0.0100)", "_FINISH,0.0100)\nOTOL=0.01")), "");
  RefusesChange("_ORI_FINISH", "_OFF", "tolerances of rounded corners");
}

/// The machine's CUST_832 sets compressor and rounding.
TEST_F(Sinumerik, TolerancesStandBeforeTheRounding) {
  const std::string cycle = "CYCLE832(0.0100,_ORI_FINISH,0.0100)\n", rounding = "COMPOF G642\n";
  RefusesChange(cycle + rounding, rounding + cycle, "COMPOF, G642 between the last TRAORI");
  for (const std::string values : {"0,_ORI_FINISH,0.01", "-0.01,_FINISH,1", "0.01,_ORI_FINISH,0"})
    RefusesChange("0.0100,_ORI_FINISH,0.0100", values, "tolerances above 0");
}

TEST_F(Sinumerik, WhatTheControlRefusesIsRefused) {
  Refuses("G4", kLinkMove, 1, "G4 needs F");
  Refuses("G90 LABEL:", kLinkMove, 1, "a word of a milling program");
  for (const std::string line : {"G 90", "F 80", "WHEN TRUE DO $A_OUT[1.5]=1", "WHEN TRUE DO $A_OUT[1]=2"})
    Refuses(line, kCut, 3, "");
  RefusesChange("G17 ", "", "G17 must be stated");
}

TEST_F(Sinumerik, JointBlocksSuppressFrames) {
  RefusesChange("G0 SUPA RA1", "G0 RA1", "SUPA expected");
  RefusesChange("\nG1 X", "\nSUPA G1 X", "without SUPA");
}

TEST_F(Sinumerik, WordsStandOnceAndAreDecimal) {
  for (const std::string end : {" X1", " F80 F80", " A=1", " G1", " G0", " CP PTP", " G9 G9"})
    sample.ExpectRefused(sample.Changed("\nG1 X", "\nG1" + end + " X"), end, "");
  sample.ExpectRefused(sample.Changed(" STAT='B", " STAT='B010' STAT='B"), "STAT", "one STAT in a block");
  for (const std::string end : {"E1", "EX1", "1e308", ",5"})
    sample.ExpectRefused(sample.Behind("\nG1 X", end), end, "");
  RefusesChange("RA2=-", "RA2=1e308 ;", "");
  RefusesChange("RA2=-", "RA2=1000000 ;", "a number from");
}

TEST_F(Sinumerik, BlocksHaveALargestLength) {
  const std::string block = "G90 ;" + std::string(507, 'x');
  Takes(block, kCut, 3);
  Refuses(block + "x", kCut, 3, "at most 512 characters");
}

TEST_F(Sinumerik, AStraightMotionIsG1WithCp) {
  RefusesChange("\nG1 X", "\nG0 X", "G0 with PTP or G1 with CP expected");
  RefusesChange(" CP\n", "\n", "G0 with PTP or G1 with CP expected");
  RefusesChange("TRAORI\n", "TRAORI G90\n", "a block of its own");
}

}  // namespace
}  // namespace millpose
