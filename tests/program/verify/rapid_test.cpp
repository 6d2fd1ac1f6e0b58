// SPDX-License-Identifier: GPL-3.0-or-later
// RAPID replayed through arm and cell: what is written is confirmed, damage is caught with its line, harmless
// edits pass.
#include "program/rapid/rapid.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "base/error.hpp"
#include "program/scanner.hpp"
#include "program/verify/verify.hpp"
#include "tests/program/station_plan.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {
namespace {

/// The `nth` line that matches `pattern` has `from` replaced by `to`; empty `from`: the line is dropped.
struct RapidEdit {
  const char* pattern;
  int nth;
  const char *from, *to;
};

const char* const kCutLine = "^MoveL ";
const char* const kWayLine = "^MoveAbsJ ";

class RapidReplay : public testing::Test {
 protected:
  PostSettings settings = SampleSettings("rapid");
  PlanResult plan = SamplePlan({.wall_turn_deg = -75, .wall_yaw_deg = 12, .tilt_deg = 7});
  MotionProgram program = [this] {
    MotionOptions feeds = SampleFeeds();
    feeds.outputs = {{5, true, 0, true}, {5, false, 0, false}};
    return MakeMotionProgram(plan, feeds);
  }();
  RapidPost post;
  World world{SampleCell(plan)};
  VerifyOptions options = SampleOptions(plan);
  ProgramFiles files = post.Write(program, plan.arm, settings);
  const std::string text = files.begin()->second;
  MotionProgram as_written = post.Read(files, plan.arm, settings);

  void SetUp() override { options.written = &as_written; }

  static std::string Edited(const std::string& text, const RapidEdit& edit) {
    std::string result;
    int seen = 0;
    bool done = false;
    const std::regex pattern(edit.pattern);
    for (const std::string_view view : SplitLines(text)) {
      std::string line(view);
      if (!done && std::regex_search(line, pattern) && seen++ == edit.nth) {
        done = true;
        if (*edit.from == '\0') continue;
        const std::string before = line;
        line =
            std::regex_replace(line, std::regex(edit.from), edit.to, std::regex_constants::format_first_only);
        EXPECT_NE(line, before) << edit.pattern << edit.from;
      }
      result += line + "\n";
    }
    EXPECT_TRUE(done) << edit.pattern;
    return result;
  }

  /// What reading and replaying say of the text, with lines; empty: it is confirmed.
  std::vector<std::pair<int, std::string>> Said(const std::string& edited) const {
    std::vector<std::pair<int, std::string>> said;
    try {
      const MotionProgram read = post.Read({{files.begin()->first, edited}}, plan.arm, settings);
      for (const Finding& finding : Verify(read, world, &program, options, {.threads = 2}))
        said.emplace_back(finding.line, finding.message);
    } catch (const InputError& error) {
      for (const Problem& problem : error.problems()) said.emplace_back(problem.place.line, problem.message);
    }
    return said;
  }
};

TEST_F(RapidReplay, IsConfirmed) {
  options.interference = true;
  for (const auto& [line, message] : Said(text)) ADD_FAILURE() << line << ": " << message;
}

TEST_F(RapidReplay, DamageIsCaughtWithItsLine) {
  const std::vector<RapidEdit> damages = {
      {"^MoveL .*fine", 2, "", ""},
      {kCutLine, 0, "", ""},
      {kWayLine, 1, "", ""},
      {kWayLine, 2, "", ""},
      {"^SetDO do5", 0, "", ""},
      {"^SetDO do5", 1, ",0", ",1"},
      {"^SetDO do5", 0, "do5", "do6"},
      {"^SetAO", 0, "", ""},
      {"^SetAO", 0, "7000", "700"},
      {"^! PASS 1", 0, "", ""},
      {"^! PASS 0", 0, "PASS 0", "PASS 3"},
      {kCutLine, 5, "\\[\\[(-?[0-9]+)", "[[1$1"},
      {kCutLine, 6, "(\\.[0-9])",
       "$1"
       "7"},
      {"^MoveL .*mp_z", 2, "mp_z[0-9]+", "fine"},
      {"^MoveL .*mp_z", 1, "mp_v[0-9]+", "mp_v4"},
      {kCutLine, 3, "fine|mp_z1", "mp_z9"},
      {kCutLine, 4, ",fine,|,mp_z[0-9]+,", ",z1,"},
      {kCutLine, 4, "\\],\\[(-?[0-9]+),", "],[7,"},
      {kCutLine, 4, "9E9,9E9,9E9,9E9,9E9,9E9", "0,9E9,9E9,9E9,9E9,9E9"},
      {kWayLine, 2, "\\[\\[(-?[0-9]+)", "[[1$1"},
      {kWayLine, 1, "MoveAbsJ", "MoveJ"},
      {"^mp_wobj", 0, "", ""},
      {"^mp_wobj", 0, "\\[\\[([0-9]+)", "[[1$1"},
      {"^mp_wobj", 1, "\\[\\[([0-9]+)", "[[1$1"},
      {"^mp_tool:=", 0, "", ""},
      {"^mp_tool:=", 0, "\\[\\[-250", "[[-251"},
      {"speeddata mp_v2", 0, ":=\\[([0-9]+)", ":=[1$1"},
      {"speeddata mp_v3", 0, ":=\\[([0-9.]+),200", ":=[$1,0.01"},
      {"zonedata mp_z1", 0, ":=\\[FALSE,[0-9.]+,[0-9.]+,[0-9.]+", ":=[FALSE,5,5,5"},
      {"speeddata mp_way", 0, "500", "900"},
      {"^ConfL", 0, "", ""},
      {"^ConfL", 0, "On", "Off"},
      {"^SingArea", 0, "Off", "Wrist"},
      {"^VelSet", 0, "100,", "50,"},
      {"^GripLoad", 0, "load0", "mp_load"},
      {"^ENDPROC", 0, "", ""},
      {"^ENDMODULE", 0, "", ""},
      {"^MODULE", 0, "Sample", "Simple"}};
  for (const RapidEdit& damage : damages) {
    const auto said = Said(Edited(text, damage));
    EXPECT_FALSE(said.empty()) << damage.pattern << " " << damage.nth << " " << damage.from;
    if (!said.empty()) {
      EXPECT_GT(said.front().first, 0) << damage.pattern << said.front().second;
    }
  }
}

TEST_F(RapidReplay, HarmlessEditsPass) {
  const std::vector<RapidEdit> edits = {{kCutLine, 3, "MoveL ", "   movel  "},
                                        {kCutLine, 4, ";$", " ; ! checked"},
                                        {kCutLine, 4, "9E9", "9E+09"},
                                        {kCutLine, 5, "(\\.[0-9]{3})[0-9]", "$1"},
                                        {"^PDispOff", 0, "PDispOff;", "PDispOff ;"},
                                        {"^ConfJ", 0, "ConfJ\\\\On", "confj \\on"},
                                        {"^LOCAL PERS wobjdata", 0, "\\[\\[[0-9]+", "[[7"},
                                        {"^ENDPROC", 0, "^", "! somebody's remark: here\n"},
                                        {kWayLine, 1, "^", "\n  \n"}};
  for (const RapidEdit& edit : edits)
    for (const auto& [line, message] : Said(Edited(text, edit)))
      ADD_FAILURE() << edit.pattern << " " << edit.from << ": " << line << ": " << message;
}

TEST(RapidAxes, AreReplayed) {
  for (const char* axes : {"rail", "both"})
    for (const bool moves_along : {false, true}) {
      const PlanResult plan = moves_along ? RidePlan(axes) : StationPlan(axes);
      const StationPost cell("rapid", plan, true);
      const MotionProgram program = MakeMotionProgram(plan, SampleFeeds());
      const ProgramFiles files = cell.Write(program, plan.arm);
      const World world(SampleCell(plan));
      const auto findings = [&](const std::string& text) {
        const MotionProgram read = cell.post->Read({{files.begin()->first, text}}, plan.arm, cell.settings);
        return Verify(read, world, &program, SampleOptions(plan), {.threads = 2});
      };
      const std::string& text = files.begin()->second;
      for (const Finding& finding : findings(text))
        ADD_FAILURE() << axes << moves_along << finding.line << ": " << finding.message;
      // An axis that is off by 1 mm or degree somewhere in a cut.
      std::string other = text;
      const size_t cut = other.find("MoveL "),
                   eax = other.find(",[", other.find("],[", other.find("],[", cut) + 3) + 3) + 2;
      other.replace(eax, other.find(',', eax) - eax, fmt::format("{:.3f}", std::stod(other.substr(eax)) + 1));
      bool caught = false;
      try {
        caught = !findings(other).empty();
      } catch (const InputError&) {
        caught = true;
      }
      EXPECT_TRUE(caught) << axes << moves_along;
    }
}

}  // namespace
}  // namespace millpose
