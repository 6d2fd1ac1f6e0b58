// SPDX-License-Identifier: GPL-3.0-or-later
// URScript: what is written reads back, blends never meet, and what is neither modelled nor allowed is
// refused at its line.
#include "program/urscript/urscript.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "base/error.hpp"
#include "base/units.hpp"
#include "machine/motion/rotation_vector.hpp"
#include "program/scanner.hpp"
#include "program/urscript/urscript_rounding.hpp"
#include "tests/program/program_lines.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

class UrScript : public testing::Test {
 protected:
  UrScriptPost post;
  PostSettings settings = SampleSettings("urscript");
  PlanResult plan = SamplePlan();
  MotionProgram program = MakeMotionProgram(plan);
  ProgramFiles files = post.Write(program, plan.arm, settings);

  MotionProgram Read(const ProgramFiles& texts) const { return post.Read(texts, plan.arm, settings); }
};

TEST_F(UrScript, WritesTheSameAgainAfterReading) {
  EXPECT_EQ(post.Write(Read(files), plan.arm, settings), files);
  settings.tool_axis = FrameAxis::kMinusX;
  settings.axes = AxisConvention::OfSigns({1, -1, 1, 1, -1, 1}, (Joints() << 1, 0, 0, -2, 0, 0).finished());
  const ProgramFiles other = post.Write(program, plan.arm, settings);
  EXPECT_NE(other, files);
  EXPECT_EQ(post.Write(Read(other), plan.arm, settings), other);
  EXPECT_LT((*Read(other).motions.front().q - plan.home).norm(), 1e-6);
}

TEST_F(UrScript, TextIsPlainAndOneFunction) {
  ASSERT_EQ(files.size(), 1u);
  const auto& [name, text] = *files.begin();
  EXPECT_EQ(name, "Sample_wall_plan.script");
  EXPECT_NE(text.find("\ndef Sample_wall_plan():\n"), std::string::npos);
  EXPECT_TRUE(text.ends_with("\nend\n"));
  for (const std::string_view line : SplitLines(text)) EXPECT_LE(line.size(), 120u) << line;
  for (const char c : text) ASSERT_TRUE(c == '\n' || (c >= ' ' && c <= '~'));
}

TEST_F(UrScript, RoundingKeepsTipOrderFeedsAndStops) {
  const MotionProgram read = Read(files);
  ASSERT_EQ(read.motions.size(), program.motions.size());
  for (size_t i = 0; i < read.motions.size(); ++i) {
    const Motion &given = program.motions[i], &motion = read.motions[i];
    EXPECT_EQ(motion.type, given.type);
    EXPECT_EQ(motion.pass, given.pass);
    EXPECT_EQ(motion.q.has_value(), given.type == MotionType::kJoint);
    const Pose wanted = *program.X_BP * given.X_PT;
    const Pose written =
        motion.q ? ForwardFlange(plan.arm, *motion.q) * *read.X_FT : *read.X_BP * motion.X_PT;
    if (motion.q) {
      EXPECT_LT((*motion.q - *given.q).cwiseAbs().maxCoeff(), 1e-7);
      continue;
    }
    EXPECT_EQ(motion.exact, given.exact);
    EXPECT_NEAR(motion.feed, given.feed, 1e-4);
    EXPECT_LT((wanted.translation() - written.translation()).norm(), 2e-4);
    EXPECT_LT(RotationVector(wanted.linear().transpose() * written.linear()).norm(), 2e-7);
  }
}

TEST_F(UrScript, EventsAreReadBack) {
  MotionOptions options = SampleFeeds();
  options.outputs = {{5, true, 0, true}, {5, false, 0, false}};
  options.dwell = 0.25;
  program = MakeMotionProgram(plan, options);
  const MotionProgram read = Read(post.Write(program, plan.arm, settings));
  std::vector<ProgramEvent> events = read.events;
  std::erase_if(events, [](const ProgramEvent& event) { return event.kind >= ProgramEvent::Kind::kText; });
  ASSERT_EQ(events.size(), program.events.size());
  for (size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(events[i].kind, program.events[i].kind);
    EXPECT_EQ(events[i].before_motion, program.events[i].before_motion);
    EXPECT_NEAR(events[i].value, program.events[i].value, 1e-9);
    EXPECT_EQ(events[i].output.number, program.events[i].output.number);
    EXPECT_EQ(events[i].output.on, program.events[i].output.on);
  }
}

TEST_F(UrScript, TheNoticeOfACompensatedProgramIsAPopup) {
  program.notice = kCompensatedNotice;
  const ProgramFiles noticed = post.Write(program, plan.arm, settings);
  EXPECT_EQ(Read(noticed).notice, kCompensatedNotice);
  EXPECT_EQ(Read(files).notice, "");
  EXPECT_EQ(post.Write(Read(noticed), plan.arm, settings), noticed);
}

// The law of ChooseBlends: no two meet, every bound is within the cell's, and where there is room none could
// be half as large again.
TEST_F(UrScript, BlendsNeverMeetAndAreAsLargeAsTheCellAllows) {
  for (const double most : {0.004, 0.02, 0.05, 0.4}) {
    for (const double spacing : {0.05, 0.7, 4.0}) {
      settings.max_corner = most;
      MotionProgram rounded =
          MakeMotionProgram(SamplePlan({.points = 8, .spacing = spacing, .stepover = 2 * spacing}));
      ChooseBlends(rounded, settings);
      EXPECT_EQ(rounded.corner_assumption, kUrScriptCorner);
      size_t corners = 0;
      for (size_t i = 1; i + 1 < rounded.motions.size(); ++i) {
        const Motion &motion = rounded.motions[i], &next = rounded.motions[i + 1];
        if (motion.type == MotionType::kJoint) {
          EXPECT_TRUE(motion.exact);
        }
        if (motion.type != next.type || motion.type == MotionType::kJoint) continue;
        const double distance = (next.X_PT.translation() - motion.X_PT.translation()).norm();
        EXPECT_LT(motion.blend + next.blend, std::max(distance, 1e-9));
        if (motion.exact) continue;
        ++corners;
        const Corner corner = CornerBetween(rounded.motions[i - 1].X_PT, motion.X_PT, next.X_PT);
        EXPECT_LE(motion.blend / 2 * corner.bend, kWrittenShare * most * 1.0001);
        EXPECT_LE(motion.blend / 2 * corner.twist, settings.tolerance.angle * 1.0001);
        const double more = 1.5 * motion.blend;
        EXPECT_TRUE(more > kBlendShare / 2 * corner.shorter ||
                    more / 2 * corner.bend > kWrittenShare * most ||
                    more / 2 * corner.twist > settings.tolerance.angle)
            << i;
      }
      EXPECT_GT(corners, 20u);
    }
  }
}

TEST(UrScriptZero, IsTheMakersTable) {
  // UR10e: d1 180.7, a2 -612.7, a3 -571.55, d4 174.15, d5 119.85, d6 116.55; at zero the arm lies stretched
  // out along -X of the base, the flange looks along -Y.
  Arm arm;
  arm.family = ArmFamily::kParallelAxes;
  arm.d1 = 180.7, arm.a1 = 0, arm.dy = 174.15, arm.a2 = 612.7, arm.d4 = 571.55, arm.dz = 0, arm.d5 = 119.85,
  arm.d6 = 116.55;
  const AxisConvention zero = UrScriptPost().OwnZero()->After(InnerConvention(arm));
  const Pose X_BF = ForwardFlange(arm, zero.ToArm(Joints::Zero()));
  EXPECT_LT((X_BF.translation() - Eigen::Vector3d(-1184.25, -290.7, 60.85)).norm(), 1e-9);
  EXPECT_LT((X_BF.linear().col(2) - Eigen::Vector3d(0, -1, 0)).norm(), 1e-9);
  // Each joint turned by itself, by the table's own product.
  const double a[] = {0, -612.7, -571.55, 0, 0, 0}, d[] = {180.7, 0, 0, 174.15, 119.85, 116.55},
               alpha[] = {kPi / 2, 0, 0, kPi / 2, -kPi / 2, 0};
  const Joints q = (Joints() << 0.3, -1.2, 0.9, -0.7, 1.1, 2.5).finished();
  Pose product = Pose::Identity();
  for (int i = 0; i < 6; ++i)
    product = product * Eigen::AngleAxisd(q[i], Eigen::Vector3d::UnitZ()) *
              Eigen::Translation3d(a[i], 0, d[i]) * Eigen::AngleAxisd(alpha[i], Eigen::Vector3d::UnitX());
  EXPECT_LT((ForwardFlange(arm, zero.ToArm(q)).matrix() - product.matrix()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(UrScriptCell, SaysWhatItLacks) {
  PostSettings settings = SampleSettings("urscript");
  EXPECT_EQ(UrScriptPost().WhyNotIn(settings), "");
  settings.outputs = {{8, true, 0, true}};
  EXPECT_NE(UrScriptPost().WhyNotIn(settings).find("allowed: the standard outputs 0 to 7"),
            std::string::npos);
  settings.outputs.clear();
  settings.load.reset();
  EXPECT_NE(UrScriptPost().WhyNotIn(settings).find("tool.load is missing"), std::string::npos);
}

constexpr const char* kScriptCut = "^movep.*r=0\\.0+[1-9]";
constexpr const char* kScriptWay = "^movej";

/// Whether the line at `index` is refused, with `why` in the message.
testing::AssertionResult ScriptRefused(const ProgramLines& sample, size_t index, const std::string& why) {
  const std::vector<Problem> problems = sample.Problems();
  for (const Problem& problem : problems)
    if (problem.place.line == static_cast<int>(index) + 1 && problem.message.find(why) != std::string::npos)
      return testing::AssertionSuccess();
  return testing::AssertionFailure() << sample.lines[index] << ": "
                                     << (problems.empty() ? "read" : problems[0].message);
}

testing::AssertionResult ScriptRefusedWith(const char* pattern, int nth, const std::string& what,
                                           const std::string& with, const std::string& why) {
  ProgramLines sample("urscript");
  const size_t at = sample.Find(pattern, nth);
  const std::string before = sample.lines[at];
  sample.lines[at] =
      std::regex_replace(before, std::regex(what), with, std::regex_constants::format_first_only);
  EXPECT_NE(sample.lines[at], before) << what;
  return ScriptRefused(sample, at, why);
}

testing::AssertionResult ScriptRefusedBefore(const char* pattern, int nth, const std::string& statement,
                                             const std::string& why) {
  ProgramLines sample("urscript");
  const size_t at = sample.Find(pattern, nth);
  sample.Insert(at, statement);
  return ScriptRefused(sample, at, why);
}

testing::AssertionResult ScriptReadBefore(const char* pattern, int nth, const std::string& statement) {
  ProgramLines sample("urscript");
  sample.Insert(sample.Find(pattern, nth), statement);
  const std::vector<Problem> problems = sample.Problems();
  return problems.empty() ? testing::AssertionSuccess() : testing::AssertionFailure() << problems[0].message;
}

TEST(UrScriptReader, BlendsThatMeetLosePoints) {
  EXPECT_TRUE(ScriptRefusedWith(kScriptCut, 1, "r=[0-9.]+", "r=0.0039", "make the controller skip a move"));
  EXPECT_TRUE(ScriptRefusedWith(kScriptCut, 1, "r=[0-9.]+", "r=0.05", "make the controller skip a move"));
  EXPECT_TRUE(ScriptRefusedWith(kScriptCut, 1, "r=[0-9.]+", "r=-0.001", "r of 0 or more expected"));
  EXPECT_TRUE(
      ScriptRefusedWith(kScriptCut, 1, "movep", "movel", "movep expected: the motion before blends into it"));
  ProgramLines open("urscript");  // a blend into a way
  size_t at = open.Find(kScriptWay, 4);
  while (!open.lines[at - 1].starts_with("movep")) --at;
  open.lines[at - 1] = std::regex_replace(open.lines[at - 1], std::regex("r=[0-9.]+"), "r=0.0010000");
  EXPECT_FALSE(open.Problems().empty());
}

TEST(UrScriptReader, WaysAreJointsFromStopToStop) {
  EXPECT_TRUE(
      ScriptRefusedWith(kScriptWay, 1, "movej\\(\\[", "movej(p[", "a pose leaves the configuration open"));
  EXPECT_TRUE(ScriptRefusedWith(kScriptWay, 1, "\\)$", ", r=0.01)", "r=0 expected"));
  EXPECT_TRUE(ScriptRefusedWith(kScriptWay, 1, "\\)$", ", t=2)", "one of a, v, r by name expected"));
  EXPECT_TRUE(ScriptRefusedWith(kScriptWay, 1, "v=[0-9.]+", "v=3.1", "v from"));
  EXPECT_TRUE(ScriptRefusedWith(kScriptWay, 1, "a=[0-9.]+", "a=30", "a from"));
  EXPECT_TRUE(ScriptRefusedWith(kScriptWay, 1, ", v=[0-9.]+", "", "v= expected"));
  ProgramLines first("urscript");
  first.lines.erase(first.lines.begin() + static_cast<long>(first.Find(kScriptWay)),
                    first.lines.begin() + static_cast<long>(first.Find("^movep")));
  EXPECT_FALSE(first.Problems().empty());
}

TEST(UrScriptReader, UnknownFunctionsAreRefused) {
  for (const std::string statement :
       {"servoj([0, 0, 0, 0, 0, 0], t=0.008)", "movec(p[0, 0, 0, 0, 0, 0], p[0, 0, 0, 0, 0, 0])",
        "set_payload_mass(2)", "speedl([0, 0, 0, 0, 0, 0], 1)", "x = 1", "force_mode_example()",
        "if True:", "thread t():", "MOVEJ([0, 0, 0, 0, 0, 0], a=1, v=1)", "; M5", "set_gravity([0, 0, 9.82])",
        "sync()", "set_configurable_digital_out(1, True)", "halt"})
    EXPECT_TRUE(ScriptRefusedBefore(kScriptWay, 3, statement, "")) << statement;
}

TEST(UrScriptReader, LooksAreNoMatter) {
  for (const std::string statement :
       {"# a remark", "", "   ", "  sleep( 0.5 )", "textmsg(\"hello # no remark\")  # a remark",
        "popup(\"go on\", blocking=True)", "set_payload(85, [-0.12, 0, 0.13])"})
    EXPECT_TRUE(ScriptReadBefore(kScriptWay, 3, statement)) << statement;
}

TEST(UrScriptReader, NothingStopsInACut) {
  for (const std::string statement :
       {"sleep(0.5)", "textmsg(\"hello\")", "popup(\"go on\", blocking=True)",
        "set_standard_digital_out(2, True)", "set_payload(85, [-0.12, 0, 0.13])"})
    EXPECT_TRUE(ScriptRefusedBefore(kScriptCut, 2, statement, "is not allowed in a cut")) << statement;
}

TEST(UrScriptReader, HeadAndEnd) {
  EXPECT_TRUE(ScriptRefusedWith("^def", 0, "Sample", "Simple", "the file's name Sample_wall_plan expected"));
  EXPECT_TRUE(ScriptRefusedWith("^set_payload", 0, "85", "86", "as the cell's tool.load has it"));
  EXPECT_TRUE(ScriptRefusedBefore(kScriptWay, 4, "set_tcp(p[0, 0, 0.1, 0, 0, 0])", "one tool for all poses"));
  for (const char* setting : {"^set_tcp", "^set_payload"}) {
    ProgramLines without("urscript");
    without.lines.erase(without.lines.begin() + static_cast<long>(without.Find(setting)));
    ASSERT_FALSE(without.Problems().empty());
    EXPECT_NE(without.Problems()[0].message.find("must be stated before the first motion"),
              std::string::npos);
  }
  ProgramLines endless("urscript");
  endless.lines.erase(endless.lines.begin() + static_cast<long>(endless.Find("^end")));
  EXPECT_FALSE(endless.Problems().empty());
  ProgramLines more("urscript");
  more.lines.insert(more.lines.begin() + static_cast<long>(more.Find("^end")) + 1, "sleep(1)");
  EXPECT_FALSE(more.Problems().empty());
}

TEST(UrScriptReader, NumbersAreDecimal) {
  for (const std::string number : {"1e-3", ".5", "5.", "+1", "0x1", "d2r(3)", "1,5"})
    EXPECT_TRUE(ScriptRefusedWith(kScriptCut, 1, "v=[0-9.]+", "v=" + number, "")) << number;
}

TEST(UrScriptTexts, MaySwitchAndWait) {
  PostSettings settings = SampleSettings("urscript");
  const auto problems = [&](const std::string& text) {
    settings.texts["spindle_on"] = text;
    return UrScriptPost().CheckTexts(SampleArm(), settings);
  };
  EXPECT_TRUE(problems("set_standard_analog_out(0, {rpm}/24000)\n"
                       "while get_standard_digital_in(2) == False:\n  sync()\nend\nsleep(1)")
                  .empty());
  EXPECT_TRUE(problems("popup(\"{rpm}\", title=\"spindle\", blocking=True)\ntextmsg(\"on\")").empty());
  for (const char* text : {"movej([0, 0, 0, 0, 0, 0], a=1, v=1)", "set_tcp(p[0, 0, 0, 0, 0, 0])", "x = 1",
                           "set_standard_digital_out(8, True)", "set_standard_digital_out(1, TRUE)", "end",
                           "while True:", "set_standard_analog_out(2, 0.5)", "spindle(1)"})
    EXPECT_FALSE(problems(text).empty()) << text;
  settings.calls = {{"spindle"}};
  EXPECT_TRUE(problems("spindle({rpm})").empty());
}

}  // namespace
}  // namespace millpose
