// SPDX-License-Identifier: GPL-3.0-or-later
// URScript through the replay: confirmed as written, and every damage is caught.
#include <gtest/gtest.h>

#include <regex>

#include "base/error.hpp"
#include "program/urscript/urscript.hpp"
#include "program/verify/corner_bound.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {
namespace {

class UrScriptReplay : public testing::Test {
 protected:
  UrScriptReplay() {
    MotionOptions more = SampleFeeds();
    more.outputs = {{5, true, 0, true}, {5, false, 0, false}};
    program = MakeMotionProgram(plan, more);
    files = post.Write(program, plan.arm, settings);
    as_written = post.Read(files, plan.arm, settings);
    options.written = &as_written;
  }

  /// Why the text is not let out; empty: it is.
  std::string Why(const std::string& text) const {
    try {
      const MotionProgram read = post.Read({{files.begin()->first, text}}, plan.arm, settings);
      const std::vector<Finding> findings = Verify(read, world, &program, options, {.threads = 1});
      return findings.empty() ? "" : findings[0].message;
    } catch (const InputError& error) {
      return error.what();
    }
  }
  const std::string& text() const { return files.begin()->second; }
  /// The nth match of `what` replaced.
  std::string With(const std::string& what, int nth, const std::string& with) const {
    const std::regex regex(what);
    std::string edited = text();
    std::smatch found;
    size_t from = 0;
    for (std::string rest = edited; std::regex_search(rest, found, regex); rest = edited.substr(from)) {
      const size_t at = from + static_cast<size_t>(found.position());
      const size_t length = static_cast<size_t>(found.length());
      if (nth-- == 0) return edited.replace(at, length, found.format(with));
      from = at + length;
    }
    ADD_FAILURE() << what;
    return edited;
  }

  UrScriptPost post;
  PostSettings settings = SampleSettings("urscript");
  PlanResult plan = SamplePlan({.wall_turn_deg = -75, .wall_yaw_deg = 12, .tilt_deg = 7});
  MotionProgram program;
  World world{SampleCell(plan)};
  VerifyOptions options = SampleOptions(plan);
  ProgramFiles files;
  MotionProgram as_written;
};

TEST_F(UrScriptReplay, IsConfirmedButForItsCorners) {
  EXPECT_EQ(Why(text()), "");
  const std::optional<CornerBound> bound = FindCornerBound(as_written, world.cell());
  ASSERT_TRUE(bound);
  EXPECT_GT(bound->position, 0.02);
  EXPECT_LE(bound->position, kWrittenShare * *settings.max_corner * 1.001);
  EXPECT_EQ(bound->assumption, kUrScriptCorner);
  options.max_corner = 0.9 * bound->position;
  EXPECT_NE(Why(text()).find("not documented by the maker"), std::string::npos) << Why(text());
}

TEST_F(UrScriptReplay, EveryDamageIsCaught) {
  const std::string pose =
      "movep\\(p\\[([-0-9.]+), ([-0-9.]+), ([-0-9.]+), ([-0-9.]+), ([-0-9.]+), ([-0-9.]+)\\]";
  struct ScriptDamage {
    const char* what;
    std::string find;
    int nth;
    std::string with;
  };
  const std::vector<ScriptDamage> damages = {
      {"a tip in mm", pose, 3, "movep(p[$1, $2, $3, $4, $5, $6]"},
      {"x off by 0.05 mm", "(movep\\(p\\[[-0-9]+\\.[0-9]{3})[0-9]{4}", 3, "$015555"},
      {"y and z exchanged", pose, 3, "movep(p[$1, $3, $2, $4, $5, $6]"},
      {"a turn of the other sign", pose, 3, "movep(p[$1, $2, $3, $4, $5, 0]"},
      {"a point lost", "movep[^\\n]*r=0\\.000[1-9][^\\n]*\\n", 0, ""},
      {"a point twice", "(movep[^\\n]*\\n)", 3, "$1$1"},
      {"a blend that meets the next", "r=0\\.000[1-9][0-9]*", 1, "r=0.0039"},
      {"a stop in the cut", "r=0\\.000[1-9][0-9]*", 1, "r=0"},
      {"a corner of the ring rounded by more", "r=0\\.00015[0-9]*", 2, "r=0.0004"},
      {"a turn that is rounded by more", "r=0\\.0002[0-9]*", 0, "r=0.0015"},
      {"the feed in mm/s", "v=0\\.0013333", 1, "v=1.3333"},
      {"the feed doubled", "v=0\\.0013333", 1, "v=0.0026667"},
      {"degrees for a joint", "movej\\(\\[[-0-9.]+", 1, "movej([5"},
      {"a way-point lost", "movej[^\\n]*\\n", 1, ""},
      {"another tool", "(set_tcp\\(p\\[)[-0-9.]+", 0, "$1-0.2500500"},
      {"the spindle off too early", "(movep[^\\n]*\\n)", 2, "$1set_standard_digital_out(0, False)\n"},
      {"no spindle", "set_standard_digital_out\\(0, True\\)\\n", 0, ""},
      {"another speed of it", "set_standard_analog_out\\(0, 7000", 0, "set_standard_analog_out(0, 700"},
      {"an output of another number", "set_standard_digital_out\\(5, True", 0,
       "set_standard_digital_out(4, True"},
      {"an output the other way", "set_standard_digital_out\\(5, True", 1,
       "set_standard_digital_out(5, False"},
      {"a mark lost", "textmsg[^\\n]*\\n", 1, ""},
      {"a mark of no pass", "(movej[^\\n]*\\n)", 2, "$1textmsg(\"PASS 1.1 PIECE 0\")\n"},
      {"another pass", "PASS 1 PIECE", 0, "PASS 2 PIECE"},
      {"an end too early", "(movep[^\\n]*\\n)", 5, "$1end\n"},
      {"another movej", "movep\\(p\\[", 3, "movej(p["},
  };
  for (size_t i = 1; i < damages.size(); ++i) {
    const ScriptDamage& damage = damages[i];
    EXPECT_NE(Why(With(damage.find, damage.nth, damage.with)), "") << damage.what;
  }
  EXPECT_EQ(Why(With(damages[0].find, damages[0].nth, damages[0].with)), "");  // the same again
}

TEST_F(UrScriptReplay, HarmlessEditsPass) {
  EXPECT_EQ(Why(With("v=0\\.0013333", 1, "v=0.0012")), "");
  EXPECT_EQ(Why(With("(movep[^\\n]*)\\n", 2, "  $1  # checked\n")), "");
  EXPECT_EQ(Why(With("(a=0\\.5000)", 4, "a=0.3")), "");
  EXPECT_EQ(Why(With("\\n(movej)", 2, "\n# by hand\n\n$1")), "");
}

TEST_F(UrScriptReplay, MovelIsReadAlike) {
  const UrScriptPost movel(UrScriptOptions{.movel = true});
  files = movel.Write(program, plan.arm, settings);
  EXPECT_NE(text().find("movel(p["), std::string::npos);
  EXPECT_EQ(text().find("movep"), std::string::npos);
  EXPECT_EQ(Why(text()), "");
}

}  // namespace
}  // namespace millpose
