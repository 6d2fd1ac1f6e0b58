// SPDX-License-Identifier: GPL-3.0-or-later
// Programs with external axes: confirmed as written, refused when a word of an axis or of its frame is
// another.
#include "program/verify/stations.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "base/error.hpp"
#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/program/verify/written_stations.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

struct Station : WrittenStations {
  Station(const std::string& variant, const std::string& axes, bool coupled)
      : Station(variant, StationPlan(axes), coupled) {}
  Station(const std::string& variant, PlanResult given, bool coupled)
      : WrittenStations(variant, std::move(given), coupled) {}

  /// What is wrong with an edited text; empty when it is confirmed.
  std::string Why(const std::string& edited) const {
    try {
      std::string said;
      for (const Finding& finding : Findings(edited)) {
        EXPECT_GT(finding.line, 0) << finding.message;
        said += fmt::format("{}: {}\n", finding.line, finding.message);
      }
      return said;
    } catch (const InputError& error) {
      EXPECT_GT(error.problems().front().place.line, 0) << error.what();
      return error.what();
    }
  }
};

std::string Replaced(const std::string& text, const std::string& from, const std::string& to,
                     bool all = false) {
  const std::string after = std::regex_replace(
      text, std::regex(from, std::regex::multiline), to,
      all ? std::regex_constants::format_default : std::regex_constants::format_first_only);
  EXPECT_NE(after, text) << from << " is not there";
  return after;
}

TEST(Stations, AreConfirmedAsWritten) {
  for (const std::string variant : {"krl", "sinumerik", "linuxcnc", "linuxcnc_cartesian"}) {
    for (const std::string axes : {"rail", "table", "both"}) {
      for (const bool coupled : {true, false}) {
        const Station station(variant, axes, coupled);
        EXPECT_EQ(station.Why(station.text), "") << variant << axes << coupled;
        for (const Finding& finding : station.Findings(station.text, false))
          ADD_FAILURE() << variant << axes << coupled << ": " << finding.line << ": " << finding.message;
      }
    }
  }
}

// The rail carries the base, the controller keeps the tip: E1 moves the arm, not the tip.
TEST(Stations, ProgramsWithE1ReplayToTheSameTipPath) {
  const Station station("krl", "both", true);
  const MotionProgram read = station.Read(station.text);
  std::vector<Finding> said;
  const Replay replay = ReplayTargets(read, station.cell, said);
  EXPECT_TRUE(said.empty());
  ASSERT_EQ(read.motions.size(), station.program.motions.size());
  for (size_t i = 0; i < read.motions.size(); ++i) {
    const Motion& planned = station.program.motions[i];
    const Pose X_PB = BaseInPart(station.cell, read.motions[i].external);
    const Vector3d tip =
        (X_PB * ForwardFlange(station.plan.arm, replay.targets[i]) * station.plan.X_FT).translation();
    EXPECT_LT((tip - planned.X_PT.translation()).norm(), 0.001) << read.motions[i].line;
  }
}

struct Damage {
  const char *variant, *axes;
  bool coupled;
  const char *from, *to;
  bool all;
  const char* expected;  ///< part of what is said
};

TEST(Stations, WordsOfAxesAndFramesAreRefusedWhenTheyAreOthers) {
  const std::vector<Damage> damages = {
      // E1 off by 1 mm, E2 by 0.1 degrees: in one motion, in all of a station.
      {"krl", "both", true, "^(LIN .*)E1 100", "$1E1 101", false, "the external axes move in a cut"},
      {"krl", "both", true, "E1 100", "E1 101", false, "planned: to rail 100.0000 mm"},
      {"krl", "both", true, "E1 100", "E1 101", true, "planned: to rail 100.0000 mm"},
      {"krl", "both", true, "E2 35", "E2 35.1", true, "planned: to rail 400.0000 mm, table 35.0000 deg"},
      {"krl", "rail", false, "E1 400", "E1 401", true, "planned: to rail 400.0000 mm"},
      {"krl", "both", true, ",E1 100", "", false, "field E1 is missing"},
      {"krl", "both", true, ",E2 35", "", false, "field E2 is missing"},
      {"krl", "both", true, "E1 400", "E1 4400", true, "rail at 4400.0000 mm leaves its limits"},
      // The base of the table.
      {"krl", "table", true, "^\\$BASE = EK.*\n", "", false, "$BASE must be stated"},
      {"krl", "table", true, "^\\$IPO_MODE = #BASE\n", "", false, "$IPO_MODE = #BASE must be stated"},
      {"krl", "table", true, "#BASE$", "#TCP", false, "#BASE"},
      {"krl", "table", true, "EK\\(MACHINE_DEF\\[2\\]", "EK(MACHINE_DEF[3]", false,
       "MACHINE_DEF[2] expected"},
      {"krl", "table", true, "MACHINE_DEF\\[2\\].MECH_TYPE", "MACHINE_DEF[1].MECH_TYPE", false,
       "MACHINE_DEF[2] expected"},
      {"krl", "table", true, "^\\$BASE = EK\\(.*\\{(.*)\\}\\)", "$$BASE = {$1}", false, "EK"},
      {"krl", "table", true, "^;ENDFOLD \\(PASS 0", "BAS (#INITMOV,0 )\n;ENDFOLD (PASS 0", false,
       "$BASE must be stated again"},
      {"krl", "table", true, "INV_POS\\(MP_OFF\\):MACHINE_DEF\\[2\\].ROOT",
       "INV_POS(MP_OFF):MACHINE_DEF[3].ROOT", false, ""},
      // A base for each station.
      {"krl", "table", false, "^\\$BASE = .*\n(PTP \\{X)", "$1", false, "leaves the plan"},
      // SINUMERIK.
      {"sinumerik", "both", true, "RAIL_AX=100.0000", "RAIL_AX=101.0000", true,
       "planned: to rail 100.0000 mm"},
      {"sinumerik", "both", false, "TAB_AX=35.000000", "TAB_AX=35.100000", true, "table 35.0000 deg"},
      {"sinumerik", "both", true, " RAIL_AX=100.0000", "", false, "RAIL_AX is missing"},
      {"sinumerik", "rail", true, "^(G1 X.*)$", "$1 RAIL_AX=101.0000", false,
       "the external axes move in a cut"},
      {"sinumerik", "rail", false, "^(G1 X.*)$", "$1 RAIL_AX=100.0000", false, "while TRAORI holds"},
      {"sinumerik", "rail", false, "^\\$P_UIFR.*\n(TRAORI)", "$1", false, "leaves the plan"},
      // LinuxCNC.
      {"linuxcnc", "both", false, "U100.000000", "U101.000000", true, "planned: to rail 100.0000 mm"},
      {"linuxcnc", "both", false, "V35.000000", "V35.100000", true, "table 35.0000 deg"},
      {"linuxcnc", "both", false, " U0.000000", "", false, "U is missing in the first motion"},
      {"linuxcnc", "rail", false, "^(G1 X.*) F", "$1 U101 F", false, "leaves the plan: tip off by"},
      {"linuxcnc_cartesian", "rail", false, "^(G1 X.*) F", "$1 U101 F", false, "U moves with G0 alone"},
      {"linuxcnc", "rail", false, "C0 U0 R0", "C0 R0", false, "U0 R0 expected"},
      {"linuxcnc_cartesian", "both", true, "U400.000000", "U401.000000", true,
       "planned: to rail 400.0000 mm"},
  };
  for (const Damage& damage : damages) {
    const Station station(damage.variant, damage.axes, damage.coupled);
    const std::string edited = Replaced(station.text, damage.from, damage.to, damage.all);
    const std::string why = station.Why(edited);
    EXPECT_NE(why, "") << damage.variant << " " << damage.from << " is confirmed";
    EXPECT_NE(why.find(damage.expected), std::string::npos) << damage.from << ": " << why;
  }
}

TEST(Stations, TheMoveBetweenThemIsWherePlanned) {
  const Station station("krl", "rail", true);
  const std::string home = "PTP {A1 0,A2 -90,A3 90,A4 0,A5 0,A6 0,E1 ";
  const auto with = [&](const std::string& line, const std::string& instead, bool last = false) {
    std::string edited = station.text;
    const size_t at = last ? edited.rfind(line) : edited.find(line);
    EXPECT_NE(at, std::string::npos) << line;
    return station.Why(edited.replace(at, line.size(), instead));
  };
  const std::string move = home + "400}\n";
  EXPECT_EQ(with(move, move), "");
  // Left out: the next motion would take arm and rail along together.
  EXPECT_NE(with(move, "").find("while the external axes move"), std::string::npos);
  EXPECT_NE(with(home + "0}\n", "", true), "");
  // Without a stop.
  EXPECT_NE(with(move, home + "400} C_PTP\n").find("no stop"), std::string::npos);
  // There and back once more.
  EXPECT_NE(with(move, move + home + "300}\n" + move), "");
}

/// A post beside the rail that the arm, standing at home, passes between stations 100 and 2000 mm.
TEST(Stations, WhatTheArmMeetsOnTheRailIsSeen) {
  PlanResult plan = StationPlan("rail");
  plan.passes[1].external = plan.gaps[1].external->to = plan.gaps[2].external->from = {2000};
  Station station("krl", plan, true);
  Body post;
  post.name = "post";
  post.shape = Box{{60, 30, 60}};
  const Vector3d tip = (plan.X_WB * ForwardFlange(plan.arm, plan.home) * plan.X_FT).translation();
  post.X_MG.translation() = tip + Vector3d(0, 3000, 0);
  station.cell.bodies.push_back(post);
  EXPECT_EQ(station.Why(station.text), "");
  station.cell.bodies.back().X_MG.translation() = tip + Vector3d(0, 1000, 0);
  const std::string why = station.Why(station.text);
  EXPECT_NE(why.find("post"), std::string::npos) << why;
  // Nothing at the stations themselves: it is the motion between that is reported.
  const MotionProgram read = station.Read(station.text);
  for (const Finding& finding : station.Findings(station.text)) {
    const auto motion = std::ranges::find(read.motions, finding.line, &Motion::line);
    ASSERT_NE(motion, read.motions.end());
    EXPECT_TRUE(MovesExternal(read, static_cast<size_t>(motion - read.motions.begin()))) << finding.message;
  }
}

TEST(Stations, LimitsOfExternalAxesHold) {
  Station station("linuxcnc", "table", false);
  std::vector<ExternalAxis> axes = station.plan.external_axes;
  axes[0].upper = 30 * kRadPerDeg;
  station.cell.external_axes = axes;
  EXPECT_NE(
      station.Why(station.text).find("table at 35.0000 deg leaves its limits -180.0000 deg to 30.0000 deg"),
      std::string::npos);
}

}  // namespace
}  // namespace millpose
