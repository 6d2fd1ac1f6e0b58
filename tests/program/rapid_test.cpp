// SPDX-License-Identifier: GPL-3.0-or-later
// RAPID: what is written reads back alike, num by num; what gives up safety or is not stated is refused.
#include "program/rapid/rapid.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/calling_program.hpp"
#include "program/controller_axes.hpp"
#include "program/economy.hpp"
#include "program/rapid/rapid_configuration.hpp"
#include "program/rapid/rapid_data.hpp"
#include "program/scanner.hpp"
#include "tests/program/station_plan.hpp"

namespace millpose {
namespace {

constexpr const char* kRapidMain = "Sample_wall_plan.mod";

class RapidProgram : public testing::Test {
 protected:
  PostSettings settings = SampleSettings("rapid");
  PlanResult plan = SamplePlan();
  MotionOptions options = [] {
    MotionOptions rich = SampleFeeds();
    rich.outputs = {{5, true, 0, true}, {5, false, 0, false}};
    rich.header = {{"version", "millpose 0.0.0"}};
    return rich;
  }();
  MotionProgram program = MakeMotionProgram(plan, options);
  RapidPost post;
  ProgramFiles files = post.Write(program, plan.arm, settings);

  MotionProgram Read(const ProgramFiles& texts) const { return post.Read(texts, plan.arm, settings); }

  /// The text with the first `from` replaced; the test fails where there is none.
  static std::string Edited(std::string text, const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    return text;
  }

  /// What the reader says of the edited program; empty: nothing.
  std::string Refusal(const std::string& from, const std::string& to) const {
    ProgramFiles other = files;
    other[kRapidMain] = Edited(other[kRapidMain], from, to);
    try {
      Read(other);
      return {};
    } catch (const InputError& error) {
      EXPECT_GT(error.problems().front().place.line, 0) << from;
      return error.what();
    }
  }
};

TEST_F(RapidProgram, WritesTheSameAgainAfterReading) {
  EXPECT_EQ(post.Write(Read(files), plan.arm, settings), files);
  for (const int most : {5, 12, 18}) {
    settings.max_motions = most;
    EconomyResult whole = Economise(program, {0, 0, 0});
    AddHandovers(whole.program, most);
    const ProgramFiles parts = post.Write(whole.program, plan.arm, settings);
    EXPECT_GT(parts.size(), 2u);
    EXPECT_EQ(post.Write(Read(parts), plan.arm, settings), parts);
    EXPECT_EQ(Read(parts).motions.size(), program.motions.size());
  }
}

TEST_F(RapidProgram, KeepsTipsMarksAndFeeds) {
  const MotionProgram read = Read(files);
  EXPECT_EQ(read.header, program.header);
  ASSERT_EQ(read.motions.size(), program.motions.size());
  for (size_t i = 0; i < read.motions.size(); ++i) {
    const Motion &given = program.motions[i], &motion = read.motions[i];
    EXPECT_EQ(motion.type, given.type);
    EXPECT_EQ(motion.exact, given.exact);
    EXPECT_EQ(motion.pass, given.pass);
    EXPECT_LT((*motion.q - *given.q).cwiseAbs().maxCoeff(), 2e-6) << motion.line;
    if (motion.type != MotionType::kLinear) continue;
    EXPECT_NEAR(motion.feed, given.feed, 1e-5);
    const Pose wanted = *program.X_BP * given.X_PT, written = *read.X_BP * motion.X_PT;
    EXPECT_LT((wanted.translation() - written.translation()).norm(), 0.001);
    EXPECT_LT((wanted.linear() - written.linear()).cwiseAbs().maxCoeff(), 5e-7);
  }
  std::vector<ProgramEvent> events = read.events;
  std::erase_if(events, [](const ProgramEvent& event) { return event.kind >= ProgramEvent::Kind::kText; });
  ASSERT_EQ(events.size(), program.events.size());
  for (size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(events[i].kind, program.events[i].kind);
    EXPECT_EQ(events[i].before_motion, program.events[i].before_motion);
    EXPECT_NEAR(events[i].value, program.events[i].value, 1e-9);
  }
}

TEST_F(RapidProgram, TextIsPlain) {
  for (const auto& [name, text] : files)
    for (const std::string_view line : SplitLines(text)) {
      EXPECT_LE(line.size(), post.BytesPerMotion()) << line;
      for (const char c : line) ASSERT_TRUE(c >= ' ' && c <= '~');
    }
}

TEST_F(RapidProgram, RefusesWhatGivesUpSafety) {
  EXPECT_NE(Refusal("ConfL\\On", "ConfL\\Off").find("ConfL\\On expected"), std::string::npos);
  EXPECT_NE(Refusal("ConfJ\\On", "ConfJ\\Off").find("ConfJ\\On expected"), std::string::npos);
  EXPECT_NE(Refusal("SingArea\\Off", "SingArea\\Wrist").find("SingArea\\Off expected"), std::string::npos);
  EXPECT_NE(Refusal("VelSet 100,5000", "VelSet 150,5000").find("VelSet"), std::string::npos);
  EXPECT_NE(Refusal("PDispOff", "PDispSet mp_p").find("expected"), std::string::npos);
  for (const std::string setting : {"ConfL\\On;", "PDispOff;", "EOffsOff;", "SoftDeact;", "AccSet 100,100;"})
    EXPECT_NE(Refusal(setting + "\n", "").find("must be stated before the first motion"), std::string::npos);
  EXPECT_NE(Refusal("\nmp_tool:=[TRUE", "\n! mp_tool:=[TRUE").find("the value of MP_TOOL"),
            std::string::npos);
  EXPECT_NE(Refusal("\\WObj:=mp_wobj", "").find("'\\' expected"), std::string::npos);
  EXPECT_NE(Refusal("MoveAbsJ [[0,", "MoveJ [[0,").find("MoveAbsJ"), std::string::npos);
  EXPECT_NE(Refusal("\\NoEOffs", "").find("'\\' expected"), std::string::npos);
}

TEST_F(RapidProgram, RefusesDataThatAreNotStated) {
  EXPECT_NE(Refusal(",mp_v1,", ",v10,").find("speeddata that this module declares"), std::string::npos);
  EXPECT_NE(Refusal(",mp_z1,", ",z5,").find("fine or zonedata that this module"), std::string::npos);
  EXPECT_NE(Refusal(",mp_tool\\", ",tool0\\").find("tooldata that this module"), std::string::npos);
  EXPECT_NE(Refusal("LOCAL PERS tooldata", "PERS tooldata").find("'LOCAL' expected"), std::string::npos);
  EXPECT_NE(Refusal("LOCAL CONST speeddata mp_v1", "LOCAL CONST speeddata v5").find("begins with mp_"),
            std::string::npos);
  EXPECT_NE(Refusal("[9E9,9E9", "[0,9E9").find("9E9 expected"), std::string::npos);
  EXPECT_NE(Refusal("mp_way:=[500,200", "mp_way:=[700,200").find("at most 500 mm/s"), std::string::npos);
  EXPECT_NE(Refusal(",5000,1000]", ",50,1000]").find("v_leax 5000"), std::string::npos);
  EXPECT_NE(Refusal(",90,1000,90]", ",1,1000,90]").find("zone_ori 90"), std::string::npos);
  EXPECT_NE(Refusal("mp_tool:=[TRUE,[[", "mp_tool:=[FALSE,[[").find("TRUE expected"), std::string::npos);
  EXPECT_NE(Refusal(",[85,[", ",[8.5,[").find("the cell's tool.load"), std::string::npos);
}

TEST_F(RapidProgram, AsksForUnitQuaternionsAndTheConfigurationOfThePlace) {
  const MotionProgram read = Read(files);
  const std::string& text = files.at(kRapidMain);
  const size_t line = text.find("MoveL [["), q = text.find("],[", line) + 3, conf = text.find("],[", q) + 3;
  const std::string quaternion = text.substr(q, conf - 3 - q), configuration = text.substr(conf, 8);
  ProgramFiles other = files;
  other[kRapidMain].replace(q, quaternion.size(), "0.9,0.1,0.1,0.1");
  EXPECT_THROW(Read(other), InputError);
  const size_t end = text.find(']', conf);
  for (const std::string wrong : {"3,0,0,0", "0,3,0,0", "0,0,-3,0", "0.5,0,0,0", "0,0,0,8"}) {
    other = files;
    other[kRapidMain].replace(conf, end - conf, wrong);
    EXPECT_THROW(Read(other), InputError) << configuration << wrong;
  }
}

// Joints and cfx as a public library of kinematics (py-opw-kinematics) tests them, with the lengths of an IRB
// 1660.
TEST(RapidConfiguration, CountsAsAbbDoes) {
  Arm arm;
  arm.d1 = 486.5, arm.a1 = 150, arm.a2 = 700, arm.d4 = 678, arm.dz = 110, arm.d6 = 135;
  arm.offset << 0, -kPi / 2, kPi / 2, 0, 0, 0;
  const AxisConvention own;
  const auto of = [&](std::array<double, 6> degrees) {
    return RapidConfigurationOf(arm, own, Eigen::Map<Joints>(degrees.data()) * kRadPerDeg);
  };
  EXPECT_EQ(of({-103.1, -85.03, 19.06, -70.19, -35.87, 185.01}), (RapidConfiguration{-2, -1, 2, 5}));
  EXPECT_EQ(of({-103.1, -85.03, 19.06, 109.81, 35.87, 5.01}), (RapidConfiguration{-2, 1, 0, 4}));
  EXPECT_EQ(of({-127.36, -62.29, -16.83, -120.65, 35.14, 156.58})[3], 4);
  EXPECT_EQ(of({10, 0, 0, 0.5, 30, -0.5}), (RapidConfiguration{0, 0, -1, 0}));
  EXPECT_EQ(of({10, 0, 0, 0, -30, 0})[3], 1);
  // The forearm beyond the line of the upper arm: the wrist centre is behind that.
  EXPECT_EQ(of({0, 40, -100, 0, 30, 0})[3], 2);
  EXPECT_EQ(of({0, 40, -60, 0, 30, 0})[3], 0);
}

TEST(RapidConfiguration, BordersBelongToBothQuarters) {
  const Arm arm = SampleArm();
  const AxisConvention own;
  Joints q;
  q << 90 * kRadPerDeg, -1.2, 1.5, 1e-7, 0.5, 0.3;
  for (const int cf1 : {0, 1})
    for (const int cf4 : {-1, 0})
      EXPECT_TRUE(FitsRapidConfiguration({cf1, cf4, 0, RapidConfigurationOf(arm, own, q)[3]}, arm, own, q));
  EXPECT_FALSE(FitsRapidConfiguration({2, 0, 0, RapidConfigurationOf(arm, own, q)[3]}, arm, own, q));
  EXPECT_FALSE(FitsRapidConfiguration({0, 0, 0, RapidConfigurationOf(arm, own, q)[3] ^ 4}, arm, own, q));
}

TEST(RapidData, TextsOfQuaternionsReadBackAlike) {
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector4d q =
        Eigen::Vector4d(std::cos(1 + i), std::sin(2 * i + 1), std::cos(3 * i), 0.1 * (i % 7)).normalized();
    const std::string text = rapid::QuaternionText(q);
    LineScanner scan(text, "", 0);
    const Eigen::Matrix3d R = rapid::ReadOrient(scan);
    EXPECT_EQ(rapid::QuaternionText(rapid::QuaternionOf(R, q)), text);
  }
}

TEST(RapidStationsTest, RailAndTableComeBack) {
  for (const char* axes : {"rail", "table", "both"})
    for (const bool coupled : {true, false})
      for (const bool rides : {false, true}) {
        if (rides && !coupled) continue;
        const PlanResult plan = rides ? RidePlan(axes) : StationPlan(axes);
        const StationPost post("rapid", plan, coupled);
        const ProgramFiles files = post.Write(MakeMotionProgram(plan), plan.arm);
        const MotionProgram read = post.post->Read(files, plan.arm, post.settings);
        EXPECT_EQ(post.post->Write(read, plan.arm, post.settings), files) << axes << coupled << rides;
        const std::string& text = files.begin()->second;
        EXPECT_NE(text.find("ActUnit TRACK1;"), std::string::npos);
        const bool on_unit = coupled && std::string(axes) != "rail";
        EXPECT_EQ(text.find("[FALSE,FALSE,\"STN1\",") != std::string::npos, on_unit) << axes;
      }
}

TEST_F(RapidProgram, MarksOfPassesStandInItsProcedureAlone) {
  const std::string message = "marks of passes are allowed in the program's procedure alone";
  EXPECT_NE(Refusal("PROC Sample_wall_plan()", "! PASS 1 PIECE 0\nPROC Sample_wall_plan()").find(message),
            std::string::npos);
  EXPECT_NE(Refusal("PROC main()", "PROC main()\n! END OF PASS 1 PIECE 0").find(message), std::string::npos);
}

TEST(RapidLoading, ModulesComeOneAfterTheOther) {
  const PlanResult plan = SamplePlan();
  PostSettings settings = SampleSettings("rapid");
  settings.max_motions = 12;
  RapidOptions options;
  options.load_from = "HOME:/parts";
  options.memory_kbytes = 100;
  const RapidPost post(options);
  EXPECT_EQ(post.Memory(), 0u);  // they need no room together
  const ProgramFiles files = post.Write(MakeMotionProgram(plan), plan.arm, settings);
  ASSERT_EQ(files.size(), 4u);
  const MotionProgram read = post.Read(files, plan.arm, settings);
  EXPECT_EQ(post.Write(read, plan.arm, settings), files);
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"UnLoad \"HOME:/parts/Sample_wall_plan_001.mod\";\n", ""},
           {"%\"Sample_wall_plan_001\"%;\n", ""},
           {"%\"Sample_wall_plan_002\"%", "%\"Sample_wall_plan_001\"%"},
           {"Load \\Dynamic,\"HOME:/parts/Sample_wall_plan_002.mod\";\n", ""},
           {"HOME:/parts/Sample_wall_plan_001", "HOME:/other/Sample_wall_plan_001"},
           {"\\Dynamic,", ""}}) {
    ProgramFiles other = files;
    std::string& text = other[kRapidMain];
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), from.size(), to);
    EXPECT_THROW(post.Read(other, plan.arm, settings), InputError) << from;
  }
  // Without a folder in the cell nothing may be loaded.
  EXPECT_THROW(RapidPost().Read(files, plan.arm, settings), InputError);
}

TEST_F(RapidProgram, IsCalledByItsName) {
  const CallingSyntax syntax = post.Calling();
  const CalledProgram called = AsCalled(syntax, plan.job, files);
  const std::string& text = called.files.at(kRapidMain);
  EXPECT_EQ(text.find("main"), std::string::npos);
  EXPECT_EQ(post.Read(called.files, plan.arm, settings).motions.size(), program.motions.size());
  const ProgramFiles main = WriteCalling(syntax, "two parts", {{"job", "two parts"}}, {called});
  EXPECT_EQ(ReadCalling(syntax, "two parts", main), std::vector<std::string>{"Sample_wall_plan"});
  EXPECT_EQ(
      main.at("two_parts.mod"),
      "MODULE mp_two_parts\n"
      "! written by millpose for ABB IRC5 and OmniCore (RAPID); mm, degrees, quaternions with the real part "
      "first\n"
      "PROC two_parts()\n! job: two parts\nSample_wall_plan;\nENDPROC\nPROC main()\ntwo_parts;\nENDPROC\n"
      "ENDMODULE\n");
  for (const char* word : {"test", "Main", "LOAD"})  // RAPID's own words
    EXPECT_EQ(ProgramName(syntax, word), std::string("mp_") + word);
}

TEST_F(RapidProgram, WaysAreNoFasterThanTheTipMayBe) {
  const ProgramTime fast = MeasureTime(program, plan.arm, {});
  RapidOptions slow;
  slow.way_speed = 50;
  const TimeOptions times = RapidPost(slow).Times();
  const std::vector<TimeLaw> laws = TimeMotions(program, plan.arm, times);
  EXPECT_GT(MeasureTime(program, plan.arm, times).all.Total(), fast.all.Total());
  for (size_t i = 1; i < laws.size(); ++i) {
    if (program.motions[i].type != MotionType::kJoint || laws[i].duration == 0) continue;
    for (double share = 0; share < 1; share += 0.05) {
      const auto tip = [&](double s) {
        return Eigen::Vector3d(TipOf(program, plan.arm, i, s).translation());
      };
      EXPECT_LT((tip(share + 1e-4) - tip(share)).norm() / 1e-4 * laws[i].speed, 50 * 1.02) << i;
    }
  }
}

TEST(RapidCell, SaysWhatIsMissing) {
  PostSettings settings = SampleSettings("rapid");
  EXPECT_EQ(RapidPost().WhyNotIn(settings), "");
  settings.load.reset();
  EXPECT_NE(RapidPost().WhyNotIn(settings).find("tool.load is missing"), std::string::npos);
  const PlanResult plan = StationPlan("table");
  StationPost post("rapid", plan, true);
  EXPECT_EQ(post.post->WhyNotIn(post.settings), "");
  EXPECT_NE(RapidPost().WhyNotIn(post.settings).find("work_unit is missing"), std::string::npos);
  post.settings.controller_axes[0].coupled = false;
  EXPECT_NE(post.post->WhyNotIn(post.settings).find("work_unit has no effect"), std::string::npos);
}

TEST_F(RapidProgram, TheNoticeOfACompensatedProgramIsReadAsSuch) {
  program.notice = kCompensatedNotice;
  files = post.Write(program, plan.arm, settings);
  EXPECT_EQ(Read(files).notice, kCompensatedNotice);
  EXPECT_EQ(post.Write(Read(files), plan.arm, settings), files);
  ProgramFiles other = files;
  other[kRapidMain] = Edited(other[kRapidMain], "NOT TO BE RUN TWICE", "RUN IT TWICE");
  EXPECT_EQ(Read(other).notice, "");
}

TEST_F(RapidProgram, TextsHoldOneStatementALineOfThoseAllowed) {
  const auto why = [&](const std::string& text) {
    settings.texts["header"] = text;
    const std::vector<Problem> problems = post.CheckTexts(plan.arm, settings);
    return problems.empty() ? std::string() : problems.front().message;
  };
  EXPECT_EQ(why("! ready\nSetGO go1,3;\nWaitDI di1,1;\nWaitTime 0.5;\nTPWrite \"up!\";"), "");
  EXPECT_NE(why("SetDO do1,1; SetDO do2,1;"), "");
  EXPECT_NE(why("SetDO do1,1"), "");
  EXPECT_NE(why("MoveL p1,v10,fine,tool0;"), "");
  EXPECT_NE(why("ConfL\\Off;"), "");
}

}  // namespace
}  // namespace millpose
