// SPDX-License-Identifier: GPL-3.0-or-later
// What is FANUC's own: frames and faceplate, CONFIG, whole speeds, positions that are read first, remarks.
#include "program/fanuc/fanuc.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "base/angles.hpp"
#include "base/random.hpp"
#include "program/calling_program.hpp"
#include "program/fanuc/fanuc_file.hpp"
#include "program/scanner.hpp"
#include "tests/program/program_lines.hpp"
#include "tests/program/station_plan.hpp"

namespace millpose {
namespace {

TEST(Fanuc, ItsZeroAndFramesAreThoseOfTheDataSheet) {
  // R-2000iC/165F: J1 to J6 at 0 is upper arm up, forearm level.
  Arm arm = SampleArm();
  arm.d1 = 670, arm.a1 = 312, arm.a2 = 1075, arm.d4 = 1280, arm.dz = 225, arm.d6 = 215;
  arm.sign = {1, 1, -1, -1, -1, -1};
  arm.offset << 0, -kPi / 2, kPi / 2, 0, 0, 0;
  const FanucOptions options{.user_frame = 1, .tool_frame = 1, .world_height = 670};
  const AxisConvention zero = FanucPost(options).OwnZero()->After(InnerConvention(arm));
  EXPECT_EQ(zero.matrix(), Matrix6(Matrix6::Identity()));
  EXPECT_LT(zero.offset().norm(), 1e-15);
  const PostSettings settings;
  const Pose faceplate =
      FanucBase(options) * ForwardFlange(arm, Joints::Zero()) * FanucTool(settings, Pose::Identity());
  const std::array<double, 6> shown = FanucNumbers(faceplate);
  // As the pendant shows it: x = 312 + 1280 + 215, z = 1075 + 225, from the height of axis 2.
  const std::array<double, 6> expected = {1807, 0, 1300, 180, -90, 0};
  for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(shown[i], expected[i], 1e-9) << i;
  // A tool and back.
  const Pose X_FT = SampleTool();
  EXPECT_LT((FanucFlangeTool(settings, FanucTool(settings, X_FT)).matrix() - X_FT.matrix()).norm(), 1e-12);
}

TEST(Fanuc, NumbersOfAPoseAreThoseThatReadBackToThem) {
  RandomStream random(3, 0);
  for (int k = 0; k < 2000; ++k) {
    const double pitch = k % 3 == 0 ? 90 - random.Uniform(-1e-3, 1e-3) : random.Uniform(-90, 90);
    std::array<double, 6> given = {
        random.Uniform(-3000, 3000), 1, 2, random.Uniform(-180, 180), k % 2 ? pitch : -pitch,
        random.Uniform(-180, 180)};
    const Pose pose = FromFanucNumbers(given);
    const std::array<double, 6> numbers = FanucNumbers(pose);
    const Pose back = FromFanucNumbers(numbers);
    EXPECT_EQ(FanucNumbers(back), numbers) << given[3] << " " << given[4] << " " << given[5];
    EXPECT_LT((back.linear() - pose.linear()).norm(), 4e-5) << given[4];
  }
}

TEST(Fanuc, SpeedsAreWholeAndNeverAboveTheFeed) {
  RandomStream random(4, 0);
  for (int k = 0; k < 3000; ++k) {
    const double feed = random.Uniform(10, 60000) / 60 * (k % 2 ? 1 : 0.01) + 10.0 / 60;
    const FanucSpeed speed = FanucSpeedOf(feed);
    EXPECT_LE(speed.feed(), feed * (1 + 2e-9));
    EXPECT_GE(speed.feed(), 0.5 * feed) << feed;
    EXPECT_EQ(FanucSpeedOf(speed.feed()).feed(), speed.feed());
  }
  const auto text = [](double mm_min) {
    const FanucSpeed speed = FanucSpeedOf(mm_min / 60);
    return fmt::format("{}{}", speed.number, speed.per_second ? "mm/sec" : "cm/min");
  };
  EXPECT_EQ(text(80), "8cm/min");
  EXPECT_EQ(text(600), "10mm/sec");
  EXPECT_EQ(text(99), "9cm/min");
  EXPECT_EQ(text(1000), "100cm/min");
  EXPECT_EQ(text(5), "1cm/min");  // above the feed: verification says so
}

TEST(Fanuc, RemarksHoldTheirKeysAndValues) {
  RandomStream random(5, 0);
  ProgramLines sample("fanuc");
  for (int k = 0; k < 100; ++k) {
    MotionProgram program = sample.program;
    program.header.clear();
    for (const char* key : {"job", "base_pose", "assumed", "assumed", "feed"}) {
      std::string value;
      const int words = 1 + random.Below(12);
      for (int w = 0; w < words; ++w) {
        value += w > 0 ? " " : "";
        const int letters = 1 + random.Below(w % 4 == 3 ? 70 : 12);
        for (int i = 0; i < letters; ++i) value += static_cast<char>('!' + random.Below(26));
      }
      std::ranges::replace(value, ';', ':');
      program.header.emplace_back(key, value);
    }
    const ProgramFiles files = sample.post->Write(program, sample.plan.arm, sample.settings);
    for (const std::string_view line : SplitLines(files.begin()->second)) {
      if (line.find(":  !") == 4) {
        EXPECT_LE(line.size(), 8 + kFanucRemark + 2) << line;
      }
    }
    EXPECT_EQ(sample.post->Read(files, sample.plan.arm, sample.settings).header, program.header);
  }
}

struct Slip {
  std::string pattern, to;
  std::vector<std::string> said;
};

TEST(Fanuc, WhatIsNotModelledIsRefusedAtItsPlace) {
  const std::vector<Slip> slips = {
      {"L P\\[5\\] 8cm/min CNT0", "L P[5] R[5]cm/min CNT0", {"a number expected: what a register holds"}},
      {"L P\\[5\\] 8cm/min CNT0", "L P[5] 8cm/min CNT50", {"FINE or CNT0 expected", "CNT50"}},
      {"L P\\[5\\] 8cm/min CNT0", "L P[5] 8cm/min CR5", {"FINE or CNT0 expected"}},
      {"L P\\[5\\] 8cm/min CNT0", "L P[5] 8.5cm/min CNT0", {"a whole number"}},
      {"L P\\[5\\] 8cm/min CNT0", "L P[5] 8cm/min CNT0 ACC50", {"end of the statement expected", "ACC50"}},
      {"L P\\[5\\] 8cm/min CNT0", "L PR[3] 8cm/min CNT0", {"P[n] expected"}},
      {"L P\\[5\\] 8cm/min CNT0", "L P[400] 8cm/min CNT0", {"a position of this file's /POS expected"}},
      {"L P\\[5\\] 8cm/min CNT0", "L P[1] 8cm/min CNT0", {"P[1] at line ", "has joint angles"}},
      {"J P\\[1\\] 20% FINE", "J P[5] 20% FINE", {"P[5] at line ", "has X, Y, Z"}},
      {"J P\\[1\\] 20% FINE", "J P[1] 21% FINE", {"at most 20 expected"}},
      {"J P\\[1\\] 20% FINE", "J P[1] 20% CNT10", {"'FINE' expected"}},
      {"UFRAME_NUM=1", "UFRAME_NUM=2", {"1 expected, the cell's user_frame"}},
      {"UTOOL_NUM=2", "UTOOL_NUM=1", {"2 expected, the cell's tool_frame"}},
      {"UFRAME_NUM=1", "!UFRAME_NUM=1", {"UFRAME_NUM must be stated before the first motion"}},
      {"PR\\[90,3\\]=.*;", "PR[90,4]=0 ;", {"PR[90,1] to PR[90,6] expected before"}},
      {"PR\\[90\\]=LPOS", "PR[90]=JPOS", {"'LPOS' expected"}},
      {"PR\\[90,2\\]=", "PR[91,2]=", {"90 expected, the cell's position_register"}},
      {"UF : 1, UT : 2", "UF : 2, UT : 2", {"UF 1 expected", "UFRAME_NUM selects"}},
      {"UF : 1, UT : 2", "UF : F, UT : 2", {"UF 1 expected"}},
      {"UF : 1, UT : 2", "UF : 1, UT : 1", {"UT 2 expected"}},
      {"CONFIG : '[NF] U T", "CONFIG : 'X U T", {"F or N expected"}},
      {"P\\[4\\]\\{", "P[3]{", {"P[3] is at line ", "P[4]|a position of this file's /POS"}},
      {"X = [-0-9.]+ mm", "X = 5 inch", {"'mm' expected"}},
      {"DEFAULT_GROUP = 1,\\*", "DEFAULT_GROUP = 1,1", {"1,*,*,*,* expected"}},
      {"OWNER = ", "OWNR = ", {"did you mean OWNER?"}},
      {"/PROG  .*", "/PROG  OTHER", {"the file's name Sample_wall_plan expected"}},
      {"/POS", "/POSE", {"a section /ATTR"}},
      {"/MN", "/APPL\nAUTO_SINGULARITY_HEADER;\n/MN", {"an empty section /APPL expected"}},
      {"(  DO\\[1\\]=ON) ;", "$1", {"ends in ';'"}},
      {"UFRAME_NUM=1 ;", "UFRAME_NUM=1 ; UTOOL_NUM=2 ;", {"one statement in a line"}},
      {"UFRAME_NUM=1", "UFRAMENUM=1", {"did you mean UFRAME_NUM?"}},
      {"J P\\[1\\]", "JMP LBL[1] ;\n   9:J P[1]", {"'JMP'", "the cell's texts"}},
  };
  for (const Slip& slip : slips) {
    ProgramLines sample("fanuc");
    const size_t at = sample.Find(slip.pattern);
    sample.lines[at] = std::regex_replace(sample.lines[at], std::regex(slip.pattern), slip.to);
    std::string said;
    for (const Problem& problem : sample.Problems())
      said += fmt::format("{}: {}\n", problem.place.line, problem.message);
    EXPECT_NE(said, "") << slip.to << " is read";
    for (const std::string& what : slip.said) {
      const size_t bar = what.find('|');
      const bool there = said.find(what.substr(0, bar)) != std::string::npos ||
                         (bar != std::string::npos && said.find(what.substr(bar + 1)) != std::string::npos);
      EXPECT_TRUE(there) << slip.to << ": " << said;
    }
  }
}

TEST(Fanuc, WhatMovesNothingElseIsRead) {
  for (const Slip& slip : std::vector<Slip>{
           {"COMMENT = .*", "COMMENT\t\t= \"by hand\";\nPROG_SIZE = 4757;\nLINE_COUNT = 18;", {}},
           {"/MN", "/APPL\n/MN", {}},
           {"DEFAULT_GROUP = 1,.*", "DEFAULT_GROUP\t= 1,*,*,*,*,*,*,* ;", {}},
           {"UFRAME_NUM=1", "UFRAME_NUM[GP1]= 1", {}},
           {"^ +[0-9]+:J P\\[1\\]", ":j p[ 1:\"HOME\"]", {}},
           {"P\\[1\\]\\{", "P[1:\"HOME\"]{", {}},
           {"L P\\[5\\] 8cm/min CNT0", "L P[5] 8cm/min CNT0   ", {}},
           {"^ +[0-9]+:J P\\[1\\]", "   9:   ;\n  10:  --checked ;\n  11:J P[1]", {}}}) {
    ProgramLines sample("fanuc");
    const MotionProgram before = sample.Read();
    const size_t at = sample.Find(slip.pattern);
    sample.lines[at] = std::regex_replace(sample.lines[at], std::regex(slip.pattern), slip.to);
    const MotionProgram after = sample.Read();
    ASSERT_EQ(after.motions.size(), before.motions.size()) << slip.to;
    EXPECT_EQ(after.header, before.header);
    for (size_t i = 0; i < after.motions.size(); ++i)
      EXPECT_EQ(after.motions[i].X_PT.matrix(), before.motions[i].X_PT.matrix());
  }
}

TEST(Fanuc, ConfigCountsFullTurnsOfTheAxesThatTheCellNames) {
  const ProgramLines sample("fanuc");
  const FanucOptions options{.user_frame = 1, .tool_frame = 2};
  Joints q = *sample.program.motions[2].q;
  const auto turns = [&](int axis, double degrees) {
    Joints counted = sample.settings.axes.FromArm(q);
    counted[axis - 1] = degrees * kRadPerDeg;
    return FanucConfigOf(options, sample.settings, sample.plan.arm, sample.settings.axes.ToArm(counted))
        .turns;
  };
  EXPECT_EQ(turns(4, 179), (std::array<int, 3>{0, 0, 0}));
  EXPECT_EQ(turns(4, 181), (std::array<int, 3>{1, 0, 0}));
  EXPECT_EQ(turns(4, 538), (std::array<int, 3>{1, 0, 0}));
  EXPECT_EQ(turns(6, -181), (std::array<int, 3>{0, 0, -1}));
  EXPECT_EQ(turns(6, -541), (std::array<int, 3>{0, 0, -2}));
  EXPECT_EQ(turns(1, 185), (std::array<int, 3>{0, 0, 0}));  // is none of them
  for (const std::array<int, 3>& some : {std::array<int, 3>{1, 0, -2}, std::array<int, 3>{0, 3, 0}})
    EXPECT_EQ(FanucTurns(options, FanucLeast(options, some)), some);
  // The wrist as it turns over, the elbow as it bends the other way, the arm as it reaches back.
  EXPECT_EQ(FanucConfigText({2, {0, 0, 0}}), "N U T, 0, 0, 0");
  EXPECT_EQ(FanucConfigText({4, {1, 0, -1}}), "F D T, 1, 0, -1");
  EXPECT_EQ(FanucConfigText({3, {0, 0, 0}}), "N U B, 0, 0, 0");
}

TEST(Fanuc, TextsOfTheCellAreWrittenAndExpected) {
  ProgramLines sample("fanuc");
  sample.settings.texts["header"] = "!ready\nPAYLOAD[2]";
  sample.settings.texts["footer"] = "RO[3]=OFF";
  sample.settings.texts["coolant_on"] = "DO[8]=ON\nWAIT DI[8]=ON AND DI[9]=OFF";
  sample.settings.texts["coolant_off"] = "DO[8]=OFF";
  sample.settings.texts["pass_begin"] = "R[5]={pass}";
  sample.settings.texts["pass_end"] = "CALL LIGHT(1)";
  sample.settings.texts["tool_change"] = "!take {tool}\nPAUSE";
  sample.settings.calls = {{"LIGHT"}};
  EXPECT_TRUE(sample.post->CheckTexts(sample.plan.arm, sample.settings).empty());
  const ProgramFiles files = sample.post->Write(sample.program, sample.plan.arm, sample.settings);
  const std::string& text = files.begin()->second;
  EXPECT_EQ(sample.post->Write(sample.post->Read(files, sample.plan.arm, sample.settings), sample.plan.arm,
                               sample.settings),
            files);
  for (const char* line : {"!ready", "PAYLOAD[2]", "RO[3]=OFF", "R[5]=1", "!take SPINDLE_D20"}) {
    std::string without = text;
    const size_t at = without.find(line);
    ASSERT_NE(at, std::string::npos) << line << text;
    without.replace(at, std::string(line).size(), "!nothing");
    EXPECT_THROW(sample.post->Read({{files.begin()->first, without}}, sample.plan.arm, sample.settings),
                 InputError)
        << line;
  }
  // What a program of the plant leaves set is stated again behind its call.
  EXPECT_NE(text.find("CALL LIGHT(1) ;"), std::string::npos);
  std::string lost = text;
  lost.replace(lost.find("UFRAME_NUM", lost.find("CALL LIGHT(1)")), 12, "!           ");
  EXPECT_THROW(sample.post->Read({{files.begin()->first, lost}}, sample.plan.arm, sample.settings),
               InputError);
  for (const char* wrong : {"; checked", "DO[1]=ON ;", "JMP LBL[1]", "L P[1] 8cm/min FINE"}) {
    PostSettings settings = sample.settings;
    settings.texts["header"] = wrong;
    EXPECT_FALSE(sample.post->CheckTexts(sample.plan.arm, settings).empty()) << wrong;
  }
}

TEST(Fanuc, LongProgramsAreCalledByAMainProgram) {
  ProgramLines sample("fanuc");
  sample.settings.max_motions = 12;
  const ProgramFiles files = sample.post->Write(sample.program, sample.plan.arm, sample.settings);
  ASSERT_EQ(files.size(), 4u);
  const std::string& main = files.at("Sample_wall_plan.ls");
  EXPECT_NE(main.find("CALL Sample_wall_plan_002 ;\n"), std::string::npos) << main;
  for (const auto& [name, text] : files) {
    EXPECT_TRUE(text.starts_with(fmt::format("/PROG  {}\n/ATTR\n", name.substr(0, name.size() - 3)))) << text;
    const auto count = [&](const char* pattern) {
      const std::regex regex(pattern);
      return std::distance(std::sregex_iterator(text.begin(), text.end(), regex), std::sregex_iterator());
    };
    EXPECT_EQ(count("\\nP\\[[0-9]+\\]\\{"), count(":[LJ] P\\["));
  }
  const MotionProgram read = sample.post->Read(files, sample.plan.arm, sample.settings);
  EXPECT_EQ(read.motions.size(), sample.program.motions.size());
  ProgramFiles lost = files;
  lost.erase("Sample_wall_plan_001.ls");
  EXPECT_THROW(sample.post->Read(lost, sample.plan.arm, sample.settings), InputError);
}

TEST(Fanuc, MainProgramsOfOperationsCallAndDoNothingElse) {
  const CallingSyntax syntax = SamplePost("fanuc")->Calling();
  const ProgramFiles files =
      WriteCalling(syntax, "job", {{"job", "a job with a name that takes more than a line"}},
                   {{"face_k3x9z", {}}, {"holes_a1b2c", {}}});
  ASSERT_TRUE(files.contains("job.ls"));
  for (const std::string_view line : SplitLines(files.at("job.ls"))) EXPECT_LE(line.size(), 50u);
  EXPECT_EQ(ReadCalling(syntax, "job", files), (std::vector<std::string>{"face_k3x9z", "holes_a1b2c"}));
  ProgramFiles other = files;
  std::string& text = other.at("job.ls");
  text.replace(text.find(":  CALL"), 7, ":  RUN");
  EXPECT_THROW(ReadCalling(syntax, "job", other), InputError);
  EXPECT_NE(text.find("/POS\n/END\n"), std::string::npos);
}

TEST(Fanuc, AxesBesideTheArmStandInEveryPosition) {
  const PlanResult plan = StationPlan("both");
  const StationPost post("fanuc", plan, false);
  const ProgramFiles files = post.Write(MakeMotionProgram(plan), plan.arm);
  const std::string& text = files.begin()->second;
  EXPECT_NE(text.find("DEFAULT_GROUP = 1,1,*,*,*;"), std::string::npos);
  EXPECT_NE(text.find("\n    E1 = 400.000 mm\n   GP2:\n    UF : 1, UT : 2,\n    J1 = 35.000 deg\n};"),
            std::string::npos);
  EXPECT_EQ(post.post->WhyNotIn(post.settings), "");
  const StationPost coupled("fanuc", plan, true);
  EXPECT_NE(coupled.post->WhyNotIn(coupled.settings).find("GP2_J1 is coupled: true; expected: false"),
            std::string::npos);
  const StationPost held("fanuc_held", plan, false);
  EXPECT_NE(held.post->WhyNotIn(held.settings).find("position_register is missing"), std::string::npos);
  // An axis that the controller does not count in stays where it is along a cut.
  std::string moved = text;
  const size_t way = moved.find("E1 = 400.000"), pose = moved.find("E1 = 400.000", moved.find("CONFIG", way));
  moved.replace(pose, 12, "E1 = 401.000");
  try {
    post.post->Read({{files.begin()->first, moved}}, plan.arm, post.settings);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("E1 moves in an L, by P["), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace millpose
