// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/program_name.hpp"

#include <gtest/gtest.h>

#include <set>

#include "base/error.hpp"

namespace millpose {
namespace {

constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";

TEST(Names, AreLegal) {
  EXPECT_EQ(LegalName("Sample wall-plan", 24, 1), "Sample_wall_plan");
  EXPECT_EQ(LegalName("7up", 24, 1), "mp_7up");
  EXPECT_EQ(LegalName("a1", 24, 2), "mp_a1");
  EXPECT_EQ(LegalName("", 24, 1), "mp_");
  EXPECT_EQ(LegalName("Übergröße", 24, 1).find_first_not_of(kPlain), std::string::npos);
  EXPECT_EQ(LegalName(std::string(40, 'x'), 24, 1).size(), 24u);
}

TEST(Names, WhatIsCutEndsInAHashOfTheWhole) {
  // The beginnings are the same for 24 characters; of the hash the length and the signs are fixed.
  const std::string keel = "fuselage_section_47_keel_beam_";
  std::set<std::string> names;
  for (const std::string end : {"finish", "rough", "finish2", ""}) {
    const std::string name = LegalName(keel + end, kProgramNameLength, 1);
    EXPECT_EQ(name.size(), kProgramNameLength);
    EXPECT_EQ(name.substr(0, 15), "fuselage_secti_");
    EXPECT_EQ(name, LegalName(keel + end, kProgramNameLength, 1));
    names.insert(name);
  }
  EXPECT_EQ(names.size(), 4u);
  // The same on every machine: names are on the controllers of plants already.
  EXPECT_EQ(NameHash("fuselage_section_47_keel_beam_finish"), "qc4oc");
  EXPECT_EQ(LegalName(std::string(kProgramNameLength, 'x'), kProgramNameLength, 1),
            std::string(kProgramNameLength, 'x'));
}

TEST(Names, OfOperationsTellJobsApart) {
  std::set<std::string> names;
  for (const std::string job : {"panel", "panel_2", "panel-2", "Panel"})
    for (const std::string operation :
         {"drill", "drill_holes_round_the_window", "drill_holes_round_the_hatch", "d1"}) {
      const std::string name = OperationName(job, operation);
      EXPECT_LE(name.size(), kProgramNameLength);
      // What every controller takes as it is.
      EXPECT_EQ(LegalName(name, kProgramNameLength, 2), name);
      names.insert(name);
    }
  EXPECT_EQ(names.size(), 16u);
  EXPECT_TRUE(OperationName("panel", "drill").starts_with("drill_"));
  // Where the job's name ends is part of it.
  EXPECT_NE(OperationName("a", "b_c").substr(4), OperationName("a_b", "c").substr(2));
}

TEST(Names, OfStartsAndSubprogramsKeepTheHash) {
  const std::string keel = "fuselage_section_47_keel_beam_";
  EXPECT_NE(StartName(keel + "finish", 3, 1), StartName(keel + "rough", 3, 1));
  EXPECT_EQ(StartName(keel + "finish", 13, 1).size(), kProgramNameLength);
  EXPECT_EQ(StartName("panel", 3, 1), "panel_P3_1");
  const std::string main = LegalName(keel + "rough", kProgramNameLength, 1);
  EXPECT_EQ(SubprogramName(main, 0, 24), main + "_001");
  EXPECT_EQ(SubprogramName(main, 1233, 24).size(), 24u);
}

TEST(Names, OfPartsBelongToTheirWhole) {
  for (const auto& [name, whole] : {std::pair{"panel_001", "panel"},
                                    {"Panel_P3_1", "panel"},
                                    {"panel_p12_10", "panel"},
                                    {"panel_2", ""},
                                    {"panel", ""},
                                    {"panel_", ""},
                                    {"panel_p3", ""},
                                    {"12", ""},
                                    {"", ""}})
    EXPECT_EQ(WithoutPart(name), whole) << name;
}

TEST(Names, OfToolsAreWhatTextsAndTablesHold) {
  for (const char* name : {"mill 20", "mill-20", "MILL_D20", "20", "x", "R5.5/20#2+"})
    EXPECT_TRUE(IsToolName(name)) << name;
  for (const char* name : {"", " mill", "mill ", "mill  20", "Fräser", "Ø20", "mill\"20", "mill(20)",
                           "mill;20", "{tool}", "mill\t20", "a name of more than 32 characters"})
    EXPECT_FALSE(IsToolName(name)) << name;
}

}  // namespace
}  // namespace millpose
