// SPDX-License-Identifier: GPL-3.0-or-later
// Statements that people and other posts put into programs, and that lead the arm nowhere else; names of
// tools as plants have them; words of a SINUMERIK's own.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "base/file.hpp"
#include "program/krl/krl.hpp"
#include "program/linuxcnc/linuxcnc.hpp"
#include "program/sinumerik/sinumerik.hpp"
#include "program/writer.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/program/program_lines.hpp"

namespace millpose {
namespace {

/// What the KRL reader says of `statement` before the nth line that matches `pattern`; empty: read.
std::string KrlSays(const std::string& statement, const std::string& pattern = "^PTP .*,S ", int nth = 1,
                    const PostSettings* settings = nullptr) {
  ProgramLines sample("krl");
  if (settings) sample.settings = *settings;
  sample.Insert(sample.Find(pattern, nth), statement);
  std::string said;
  for (const Problem& problem : sample.Problems()) said += problem.message + "\n";
  return said;
}

TEST(ShopStatements, HarmlessKrlIsReadOutsideCuts) {
  for (const std::string statement :
       {"$OV_PRO=50", "$OV_PRO = 100", "BAS (#ACC_PTP,50)", "BAS(#ACC_PTP,100 )", "$ACC.CP=2.3",
        "$ACC.CP = 0.5", "BAS (#VEL_CP,0.02 )", "BAS (#ACC_CP,1.5 )", "$LOAD=LOAD_DATA[3]", "$IPO_MODE=#BASE",
        "$CIRC_TYPE=#PATH", "$CIRC_TYPE = #BASE", "$APO.CPTP=50", "$APO.CVEL=90", "$APO.CORI=5",
        "$BWDSTART=FALSE", "$VEL_AXIS[1]=30", "$ACC_AXIS[6]=60", "$VEL.CP=0.02"})
    EXPECT_EQ(KrlSays(statement), "") << statement;
}

TEST(ShopStatements, KrlThatGoesFurtherIsRefused) {
  for (const std::string statement :
       {"$OV_PRO=0", "$OV_PRO=120", "$OV_PRO=12.5", "BAS (#ACC_PTP,0)", "BAS (#ACC_PTP,120)", "$ACC.CP=2.4",
        "$ACC.CP=0.1", "$ACC.CP=0", "BAS (#ACC_CP,3 )", "BAS (#VEL_CP,0 )", "$LOAD=LOAD_DATA[0]",
        "$LOAD={M 3}", "$IPO_MODE=#TCP", "$CIRC_TYPE=#VAR", "$APO.CPTP=101", "$BWDSTART=1", "$VEL_AXIS[1]=31",
        "$VEL_AXIS[0]=30", "$ACC_AXIS[1]=101"})
    EXPECT_NE(KrlSays(statement), "") << statement;
  // In a cut none of them stands.
  for (const std::string statement : {"$OV_PRO=50", "BAS (#ACC_PTP,50)", "$ACC.CP=0.5", "$CIRC_TYPE=#PATH",
                                      "$LOAD=LOAD_DATA[3]", "$IPO_MODE=#BASE", "$VEL_AXIS[1]=30"})
    EXPECT_NE(KrlSays(statement, "^LIN .*C_DIS", 2), "") << statement;
}

TEST(ShopStatements, KrlsOwnLoadDataDoNotStandForTheCells) {
  PostSettings settings = SampleSettings("krl");
  settings.load = ToolLoad{182.5, {-30, 0, 140.25}, {9.5, 11, 4.25}};
  EXPECT_NE(KrlSays("$LOAD=LOAD_DATA[3]", "^PTP .*,S ", 1, &settings).find("M 182.5"), std::string::npos);
}

TEST(ShopStatements, KrlIsSpeltAsPeopleSpellIt) {
  ProgramLines sample("krl");
  sample.lines[sample.Find("^DEF ")] = "GLOBAL DEF Sample_wall_plan( )";
  for (std::string& line : sample.lines) {
    line = std::regex_replace(line, std::regex("^LIN \\{"), "LIN { E6POS : ");
    line = std::regex_replace(line, std::regex("^PTP \\{A1"), "PTP { AXIS: A1");
    line = std::regex_replace(line, std::regex("^PTP \\{X"), "ptp{POS:X");
    if (line.starts_with("LIN") || line.starts_with("PTP"))
      line = std::regex_replace(std::regex_replace(line, std::regex(","), " , "), std::regex("\\}"), " }");
  }
  EXPECT_TRUE(sample.Problems().empty()) << sample.Problems()[0].message;
  EXPECT_EQ(sample.Read().motions.size(), sample.program.motions.size());
}

TEST(ShopStatements, KrlLeavesOutWhatStays) {
  const ProgramLines sample("krl");
  size_t without = 0;
  static const std::regex zeros("[0-9]\\.[0-9]*0[,}]");
  for (const std::string& line : sample.lines) {
    const bool motion = line.starts_with("LIN {") || line.starts_with("PTP {");
    EXPECT_FALSE(motion && std::regex_search(line, zeros)) << line;
    without += line.starts_with("LIN {") && line.find(",A ") == std::string::npos ? 1 : 0;
  }
  EXPECT_GT(without, 0u);
  // Behind a motion of axes, and where a file or a piece begins, every word stands.
  bool whole = false;
  for (const std::string& line : sample.lines) {
    if (line.starts_with("PASS_") || line.starts_with("PTP {A1")) whole = false;
    for (const char* word : {"X ", "Y ", "Z ", "A ", "B ", "C "})
      EXPECT_TRUE(whole || !line.starts_with("LIN {") || line.find(word) != std::string::npos) << line;
    if (line.starts_with("LIN {") || line.starts_with("PTP {X")) whole = true;
  }
  // A word that is taken out though it changes moves what follows: somebody's edit is no small one.
  ProgramLines edited("krl");
  const size_t cut = edited.Find("^LIN \\{X [-0-9.]+,.*C_DIS", 1);
  edited.lines[cut] = std::regex_replace(edited.lines[cut], std::regex("X [-0-9.]+,"), "");
  const MotionProgram read = edited.Read(), planned = sample.Read();
  double off = 0;
  for (size_t i = 0; i < read.motions.size(); ++i)
    if (!read.motions[i].q)
      off =
          std::max(off, (read.motions[i].X_PT.translation() - planned.motions[i].X_PT.translation()).norm());
  EXPECT_GT(off, 0.1);
}

class ToolNames : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Controllers, ToolNames, testing::Values("krl", "sinumerik", "linuxcnc"),
                         [](const auto& controller) { return controller.param; });

TEST_P(ToolNames, AreReadBackAsWritten) {
  for (const std::string name : {"mill 20", "mill-20", "20", "D20/R2 #3", "fly cutter 50 mm"}) {
    PostSettings settings = SampleSettings(GetParam());
    settings.tool_name = name;
    settings.several_tools = true;
    const std::unique_ptr<Post> post = SamplePost(GetParam());
    settings.tool_check = post->ToolCheck(settings);
    const PlanResult plan = SamplePlan();
    const ProgramFiles files = post->Write(MakeMotionProgram(plan), plan.arm, settings);
    EXPECT_NE(files.rbegin()->second.find(name), std::string::npos);
    try {
      EXPECT_EQ(post->Write(post->Read(files, plan.arm, settings), plan.arm, settings), files) << name;
    } catch (const InputError& error) {
      ADD_FAILURE() << name << ": " << error.what();
    }
  }
}

/// The sample's program with the words of a machine of its own.
struct OwnWords {
  explicit OwnWords(OrientationWords words, bool positive) {
    settings.rotation = words.group;
    SinumerikOptions options;
    options.orientation_words = std::move(words);
    options.stat_a5_positive = positive;
    post = std::make_unique<SinumerikPost>(options);
    program = MakeMotionProgram(plan);
    files = post->Write(program, plan.arm, settings);
  }
  const std::string& Text() const { return files.begin()->second; }

  PostSettings settings = SampleSettings("sinumerik");
  PlanResult plan = SamplePlan();
  std::unique_ptr<Post> post;
  MotionProgram program;
  ProgramFiles files;
};

TEST(SinumerikWords, AreTheCells) {
  for (const AngleOrder group : {AngleOrder::kRpy, AngleOrder::kRpy2, AngleOrder::kEuler}) {
    for (const std::array<std::string, 3>& names :
         {std::array<std::string, 3>{"A2", "B2", "C2"}, {"RX", "RY", "RZ"}, {"A", "B", "C"}}) {
      const OwnWords own({names, group}, false);
      EXPECT_NE(own.Text().find(" " + names[0] + "="), std::string::npos);
      EXPECT_NE(own.Text().find("G505 " + SinumerikAngleWord(group) + " ORIVECT"), std::string::npos);
      const MotionProgram read = own.post->Read(own.files, own.plan.arm, own.settings);
      ASSERT_EQ(read.motions.size(), own.program.motions.size());
      for (size_t i = 0; i < read.motions.size(); ++i)
        EXPECT_TRUE(read.motions[i].q ||
                    (read.motions[i].X_PT.matrix() - own.program.motions[i].X_PT.matrix()).norm() < 1e-3);
      EXPECT_EQ(own.post->Write(read, own.plan.arm, own.settings), own.files);
    }
  }
  // Another machine's words, and another group, are refused.
  const OwnWords own({{"A2", "B2", "C2"}, AngleOrder::kRpy}, false);
  for (const auto& [from, to] :
       {std::pair{" A2=", " A="}, {" C2=", " RX="}, {" ORIRPY ", " ORIRPY2 "}, {" ORIRPY ", " ORIEULER "}}) {
    std::string text = own.Text();
    text.replace(text.rfind(from), std::string(from).size(), to);
    EXPECT_THROW(own.post->Read({{own.files.begin()->first, text}}, own.plan.arm, own.settings), InputError)
        << to;
  }
}

TEST(SinumerikWords, Bit2OfStatIsTheCells) {
  const OwnWords negative({{"A", "B", "C"}, AngleOrder::kRpy}, false),
      positive({{"A", "B", "C"}, AngleOrder::kRpy}, true);
  static const std::regex stat("STAT='B([01])([01]{2})'");
  auto it = std::sregex_iterator(negative.Text().begin(), negative.Text().end(), stat);
  auto other = std::sregex_iterator(positive.Text().begin(), positive.Text().end(), stat);
  ASSERT_NE(it, std::sregex_iterator());
  for (; it != std::sregex_iterator(); ++it, ++other) {
    EXPECT_NE((*it)[1], (*other)[1]);
    EXPECT_EQ((*it)[2], (*other)[2]);
  }
  const MotionProgram a = negative.post->Read(negative.files, negative.plan.arm, negative.settings),
                      b = positive.post->Read(positive.files, positive.plan.arm, positive.settings);
  for (size_t i = 0; i < a.motions.size(); ++i) EXPECT_EQ(a.motions[i].status, b.motions[i].status);
  // Both are said in so many words.
  EXPECT_NE(positive.post->Assumptions(positive.settings)[1].find("A5 > 0"), std::string::npos);
  EXPECT_NE(negative.post->Assumptions(negative.settings)[1].find("A5 < 0"), std::string::npos);
}

TEST(Headers, EndAtWordsAndLoseNone) {
  const std::string value =
      "interference of link1, link2, link3 and link4 is not checked, "
      "nor is that of the spindle's hose with anything at all";
  const std::vector<std::string> lines = HeaderLines("unchecked", value, 60);
  std::string together;
  for (const std::string& line : lines) {
    EXPECT_LE(line.size(), 60u);
    ASSERT_TRUE(line.starts_with("unchecked: "));
    together += (together.empty() ? "" : " ") + line.substr(11);
  }
  EXPECT_EQ(together, value);
  EXPECT_EQ(HeaderLines("a", "", 60), std::vector<std::string>{"a:"});
  EXPECT_EQ(HeaderLines("a", std::string(130, 'x'), 60).size(), 3u);
  EXPECT_EQ(HeaderLines("part", "H\xc3\xbclle", 60)[0], "part: H??lle");
}

TEST(LinuxCncM6, MustBeKnownNotToMove) {
  PostSettings settings = SampleSettings("linuxcnc");
  settings.several_tools = true;
  settings.tool_number = 3;
  EXPECT_NE(LinuxCncPost().WhyNotIn(settings).find("m6_moves: is missing"), std::string::npos);
  EXPECT_NE(LinuxCncPost({false, true}).WhyNotIn(settings).find("m6_moves: is true"), std::string::npos);
  EXPECT_EQ(LinuxCncPost({false, false}).WhyNotIn(settings), "");
  EXPECT_NE(LinuxCncPost({false, false}).Assumptions(settings)[0].find("TOOL_CHANGE_AT_G30"),
            std::string::npos);
  // A text without M6, and one whose remark alone has it.
  for (const char* text : {"O<change> CALL", "M60", "M61 Q3", "(M6)", "M68 E3 Q1 ; no M6", "O<XM6> CALL"}) {
    settings.texts["tool_change"] = text;
    EXPECT_EQ(LinuxCncPost().WhyNotIn(settings), "") << text;
    EXPECT_NE(LinuxCncPost({false, false}).WhyNotIn(settings).find("has no effect"), std::string::npos)
        << text;
  }
  for (const char* text : {"T{number} m6", "M06T3", "T3\nM 6", "N10 T3M6"}) {
    settings.texts["tool_change"] = text;
    EXPECT_NE(LinuxCncPost().WhyNotIn(settings), "") << text;
  }
}

TEST(FirstRuns, AreListedOnTheControllersPages) {
  for (const std::string controller : {"krl", "sinumerik", "linuxcnc", "fanuc"}) {
    const std::string page = ReadFile(std::filesystem::path(SourceDir()) / "docs" / (controller + ".md"));
    const std::string list = page.substr(page.find("## Before a first run"));
    size_t at = 0;
    for (const auto& [what, how] : MakePost(controller)->BeforeFirstRun(SampleSettings(controller))) {
      EXPECT_GT(how.size(), 5u);
      const size_t row = list.find("\n| " + what + " | ", at);  // in the same order
      EXPECT_NE(row, std::string::npos) << controller << ": " << what;
      at = row == std::string::npos ? at : row;
    }
  }
}

}  // namespace
}  // namespace millpose
