// SPDX-License-Identifier: GPL-3.0-or-later
// Programs whose external axes move along cuts: confirmed as written, refused when a word of an axis is
// another; what arm and bodies meet meanwhile.
#include <gtest/gtest.h>

#include <regex>

#include "base/error.hpp"
#include "base/units.hpp"
#include "machine/collision/station_path.hpp"
#include "machine/robot/kinematics.hpp"
#include "planning/result/station.hpp"
#include "program/verify/coordinated_path.hpp"
#include "program/verify/stations.hpp"
#include "tests/program/verify/written_stations.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

struct Coordinated : WrittenStations {
  Coordinated(const std::string& variant, const std::string& axes) : Coordinated(variant, RidePlan(axes)) {}
  Coordinated(const std::string& variant, PlanResult given)
      : WrittenStations(variant, std::move(given), true) {}

  /// The findings of an edited text by line, or what its reader refuses.
  std::vector<std::pair<int, std::string>> Said(const std::string& edited, bool with_plan = true) const {
    std::vector<std::pair<int, std::string>> said;
    try {
      for (const Finding& finding : Findings(edited, with_plan))
        said.emplace_back(finding.line, finding.message);
    } catch (const InputError& error) {
      for (const Problem& problem : error.problems()) said.emplace_back(problem.place.line, problem.message);
    }
    return said;
  }
  std::string Why(const std::string& edited, bool with_plan = true) const {
    std::string all;
    for (const auto& [line, message] : Said(edited, with_plan)) {
      EXPECT_GT(line, 0) << message;
      all += fmt::format("{}: {}\n", line, message);
    }
    return all;
  }
};

const std::vector<std::string> kVariants = {"krl", "sinumerik", "sinumerik_euler", "linuxcnc",
                                            "linuxcnc_cartesian"};

TEST(RideChecks, AreConfirmedAsWritten) {
  for (const std::string& variant : kVariants)
    for (const std::string axes : {"rail", "table", "both"}) {
      Coordinated riding(variant, axes);
      for (const bool with_plan : {true, false})
        EXPECT_EQ(riding.Why(riding.text, with_plan), "") << variant << axes << with_plan;
      riding.interference = false;
      EXPECT_EQ(riding.Why(riding.text), "") << variant << axes;
    }
}

/// All lines of `text` in which an axis' word stands in a cut, and where in them its number begins and ends.
struct Word {
  int line;
  size_t begin, end;
};

std::vector<Word> WordsOfCuts(const std::string& text, const std::string& pattern) {
  std::vector<Word> words;
  const std::regex find(pattern, std::regex::multiline);
  for (auto it = std::sregex_iterator(text.begin(), text.end(), find); it != std::sregex_iterator(); ++it) {
    const auto begin = static_cast<size_t>(it->position(1)), end = begin + static_cast<size_t>(it->length(1));
    const auto line =
        static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(begin), '\n')) + 1;
    words.push_back({line, begin, end});
  }
  return words;
}

// A wrong value in one block, of either sign: found at that block or the next one.
TEST(RideChecks, EveryWrongValueIsFound) {
  struct Damage {
    const char *variant, *axes, *pattern;
  };
  const std::vector<Damage> damages = {
      {"krl", "both", "^LIN .*,E1 ([-0-9.]+)"},
      {"krl", "both", "^LIN .*,E2 ([-0-9.]+)"},
      {"sinumerik", "both", "G1 X.* RAIL_AX=([-0-9.]+)"},
      {"sinumerik", "both", "G1 X.* TAB_AX=([-0-9.]+)"},
      {"linuxcnc", "both", "^G1 .* U([-0-9.]+)"},
      {"linuxcnc", "both", "^G1 .* V([-0-9.]+)"},
      {"linuxcnc_cartesian", "both", "^G1 .* U([-0-9.]+)"},
      {"linuxcnc_cartesian", "both", "^G1 .* V([-0-9.]+)"},
  };
  for (const Damage& damage : damages) {
    Coordinated riding(damage.variant, damage.axes);
    riding.interference = false;
    const std::vector<Word> words = WordsOfCuts(riding.text, damage.pattern);
    EXPECT_GE(words.size(), 6u) << damage.pattern;
    const size_t step = std::max<size_t>(1, words.size() / 12);
    for (size_t k = 0; k < words.size(); k += step) {
      const Word& word = words[k];
      const double value = std::stod(riding.text.substr(word.begin, word.end - word.begin));
      if (std::abs(value) < 0.1) continue;  // of either sign the same
      for (const double wrong : {value + 0.1, value - 0.1, -value}) {
        std::string edited = riding.text;
        edited.replace(word.begin, word.end - word.begin, fmt::format("{:.6f}", wrong));
        const auto said = riding.Said(edited);
        ASSERT_FALSE(said.empty()) << damage.variant << ": " << damage.pattern << " line " << word.line << " "
                                   << value << " to " << wrong << " is confirmed";
        EXPECT_GT(said.front().first, 0);
        EXPECT_LE(std::abs(said.front().first - word.line), 2) << said.front().second;
      }
    }
  }
}

TEST(RideChecks, AMissingWordIsFound) {
  struct Damage {
    const char *variant, *pattern, *expected;
  };
  for (const Damage& damage :
       std::vector<Damage>{{"krl", "^LIN .*(,E1 [-0-9.]+)", "field E1 is missing"},
                           {"sinumerik", "G1 X.*( RAIL_AX=[-0-9.]+)", "leaves the plan"},
                           {"linuxcnc", "^G1 .*( U[-0-9.]+)", ""},
                           {"linuxcnc_cartesian", "^G1 .*( U[-0-9.]+)", "leaves the plan"}}) {
    Coordinated riding(damage.variant, "rail");
    riding.interference = false;
    const std::vector<Word> words = WordsOfCuts(riding.text, damage.pattern);
    ASSERT_GE(words.size(), 6u);
    const Word& word = words[words.size() / 2];
    std::string edited = riding.text;
    edited.replace(word.begin, word.end - word.begin, "");
    const std::string why = riding.Why(edited);
    EXPECT_NE(why, "") << damage.variant;
    EXPECT_NE(why.find(damage.expected), std::string::npos) << why;
  }
}

// The rail stands where the plan moves it: on a coupled one the tip does not show it.
TEST(RideChecks, AnAxisThatStandsWhereItShouldMoveIsFound) {
  Coordinated riding("krl", "rail");
  std::string edited = riding.text;
  for (const Word& word : WordsOfCuts(riding.text, "^LIN .*,E1 ([-0-9.]+)"))
    if (riding.text.substr(word.begin, 1) == "1") edited.replace(word.begin, word.end - word.begin, "100");
  ASSERT_NE(edited, riding.text);
  EXPECT_NE(riding.Why(edited).find("leaves the plan: rail at 100.0000 mm, planned: "), std::string::npos);
  // And the other way round.
  const Coordinated standing("krl", StationPlan("rail"));
  edited = std::regex_replace(standing.text, std::regex("^(LIN .*)E1 100", std::regex::multiline),
                              "$1E1 100.5", std::regex_constants::format_first_only);
  EXPECT_NE(standing.Why(edited).find("the external axes move in a cut: rail at"), std::string::npos);
}

// Neither the way there nor the way back is followed.
TEST(RideChecks, AWayToKilometresOffIsRefusedAtBothItsEnds) {
  const Coordinated riding("krl", "rail");
  const std::vector<Word> words = WordsOfCuts(riding.text, "^LIN .*,E1 ([-0-9.]+)");
  ASSERT_GT(words.size(), 3u);
  std::string edited = riding.text;
  edited.replace(words[1].begin, words[1].end - words[1].begin, "1000000");
  size_t refused = 0;
  for (const auto& [line, message] : riding.Said(edited))
    refused += message == "rail leaves its limits by more than its whole range" ? 1 : 0;
  EXPECT_EQ(refused, 2u) << riding.Why(edited);
}

TEST(RideChecks, SpeedsAndLimitsOfTheAxesHold) {
  PlanResult plan = RidePlan("rail");
  Coordinated riding("krl", plan);
  riding.interference = false;
  ASSERT_EQ(riding.Why(riding.text), "");
  const Motion* ride = nullptr;
  for (size_t i = 1; i < riding.program.motions.size() && !ride; ++i)
    if (CoordinatedMotions(riding.program, i)) ride = &riding.program.motions[i];
  ASSERT_NE(ride, nullptr);
  // 20 mm of rail while the tip goes 4 mm.
  riding.cell.external_axes[0].speed = riding.plan.external_axes[0].speed = 5 * ride->feed * 0.98;
  riding.post.settings.mechanism = Mechanism(riding.plan.external_axes);
  EXPECT_NE(riding.Why(riding.text).find("rail would move at"), std::string::npos);
  riding.cell.external_axes[0].speed = riding.plan.external_axes[0].speed = 5 * ride->feed * 1.02;
  riding.post.settings.mechanism = Mechanism(riding.plan.external_axes);
  EXPECT_EQ(riding.Why(riding.text), "");
  riding.cell.external_axes[0].upper = 430;
  EXPECT_NE(riding.Why(riding.text).find("rail at 440.0000 mm leaves its limits"), std::string::npos);
}

/// A cell and a ride of 400 mm of rail, the arm standing: what it meets is what is beside the rail.
struct RailRide {
  PlanResult plan = StationPlan("rail");
  Cell cell = SampleCell(plan);
  CoordinatedPath way{{0}, {400}, {{0, plan.home}, {1, plan.home}}};
  Vector3d tip = (plan.X_WB * ForwardFlange(plan.arm, plan.home) * plan.X_FT).translation();

  std::optional<Interference> Find() const { return FindOnCoordinatedMotion(World(cell), way, {1, 0, 0.5}); }
  void PutPost(double beside, double along) {
    Body post;
    post.name = "post";
    post.shape = Box{{60, 30, 60}};
    post.X_MG.translation() = tip + Vector3d(0, along, 0) + beside * Vector3d::UnitX();
    cell.bodies.push_back(post);
  }
};

TEST(CoordinatedPaths, WhatIsMetBetweenTheEndsIsSeen) {
  RailRide ride;
  EXPECT_FALSE(ride.Find());
  ride.PutPost(0, 200);
  const auto hit = ride.Find();
  ASSERT_TRUE(hit);
  EXPECT_TRUE(hit->first == "post" || hit->second == "post");
  ride.way.to = {20};  // stops before it
  EXPECT_FALSE(ride.Find());
}

// The answer is that of looking densely, to the resolution.
TEST(CoordinatedPaths, AgreesWithLookingDensely) {
  const PlanResult plan = StationPlan("both");
  const Cell base = SampleCell(plan);
  const Joints q = plan.passes[0].points[0].q;
  int met = 0, free = 0;
  for (int k = 0; k < 12; ++k) {
    Cell cell = base;
    Body post;
    post.name = "post";
    post.shape = Sphere{20};
    const Pose X_WT = plan.X_WB * ForwardFlange(plan.arm, q) * plan.X_FT;
    post.X_MG.translation() = X_WT * Vector3d(0, 0, 150) + Vector3d(0, 180 + 10 * (k / 6), 45.0 * (k % 6));
    cell.bodies.push_back(post);
    const World world(cell);
    Joints end = q;
    end[0] -= 0.05;
    CoordinatedPath way{{0, 0}, {60, 0.1}, {{0, q}, {1, end}}};
    bool within = false, deep = false;  // a pair below its clearance, and by more than the resolution
    for (int i = 0; i <= 120; ++i) {
      const double share = i / 120.0;
      const World there = world.At({60 * share, 0.1 * share});
      within |= Checker(there).At(q + share * (end - q), Phase::kCutting).has_value();
      deep |= Checker(there, 1, 2).At(q + share * (end - q), Phase::kCutting).has_value();
    }
    const bool found = FindOnCoordinatedMotion(world, way, {1, 0, 0.5}).has_value();
    EXPECT_TRUE(found || !deep) << k;
    EXPECT_TRUE(!found || within) << k;
    met += deep;
    free += !within;
  }
  EXPECT_GT(met, 0);
  EXPECT_GT(free, 0);
}

}  // namespace
}  // namespace millpose
