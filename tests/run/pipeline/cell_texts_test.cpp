// SPDX-License-Identifier: GPL-3.0-or-later
// A cell whose texts no reader models is refused as it is read, with the line.
#include "job/cell_texts.hpp"

#include "base/file.hpp"
#include "base/units.hpp"
#include "job/assemble.hpp"
#include "job/config/config.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

/// A shipped cell with more lines in its KRL section; the number of the first of them.
std::pair<CellSettings, int> CellWith(const std::string& lines) {
  const std::string name = std::string(SourceDir()) + "/cells/kr500_r2830.yaml";
  std::string text = ReadFile(name);
  const size_t section = text.find("\n  krl:") + 1, at = text.find("\n  sinumerik:") + 1;
  text.replace(section, at - section, "  krl:\n    tool_axis: -x\n" + lines);
  const int line =
      3 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(section), '\n'));
  return {ParseCell(text, name), line};
}

TEST(CellTextsOfACell, AreRefusedWithTheirLine) {
  const auto [cell, line] = CellWith(
      "    calls: [{name: WASH, moves: false}]\n    texts:\n      pass_begin: |\n        WASH ( )\n"
      "        LIN_REL {Z -500}\n      footer: \"PTP_REL {A1 5}\"\n");
  const std::vector<Problem> problems = CheckCellTexts(cell);
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(problems[0].place.line, line + 5);  // by name: footer, then pass_begin
  EXPECT_NE(problems[0].message.find("controllers.krl.texts.footer, its line 1"), std::string::npos);
  EXPECT_EQ(problems[1].place.line, line + 2);
  EXPECT_NE(problems[1].message.find("controllers.krl.texts.pass_begin, its line 2"), std::string::npos);
  EXPECT_EQ(problems[1].place.file, cell.file);
}

TEST(ToolNamesOfACell, AreRefusedAtTheirLineWhereProgramsAreAskedFor) {
  const std::string name = std::string(SourceDir()) + "/cells/kr500_r2830.yaml", text = ReadFile(name);
  const size_t tool = text.find("\ntool:") + 1, at = text.find("name: ", tool), end = text.find('\n', at);
  const int line = 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
  for (const auto& [given, good] : {std::pair{"mill 20", true},
                                    {"mill-20", true},
                                    {"Fr\u00e4ser", false},
                                    {"\u00d820", false},
                                    {"mill(20)", false}}) {
    std::string changed = text;
    const CellSettings cell =
        ParseCell(changed.replace(at, end - at, fmt::format("name: '{}'", given)), name);
    for (const char* controller : {"krl", "sinumerik", "linuxcnc"}) {
      try {
        MakePostSettings({}, cell, controller);
        EXPECT_TRUE(good) << given;
      } catch (const InputError& error) {
        ASSERT_FALSE(good) << error.what();
        EXPECT_EQ(error.problems()[0].place.line, line);
        EXPECT_TRUE(error.problems()[0].message.starts_with("tool.name: given '")) << error.what();
      }
    }
  }
}

TEST(AxesOfControllers, AreTheCellsAlsoWhereNobodyAsksForThem) {
  const std::string name = std::string(SourceDir()) + "/cells/kr500_rail.yaml";
  std::string text = ReadFile(name);
  text.replace(text.find("{name: U, axis: rail"), 20, "{name: U, axis: rael");
  try {
    ParseCell(text, name);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("controllers.linuxcnc.external_axes: U: given axis 'rael'; allowed: the "
                        "name of one of external_axes; did you mean 'rail'?"),
              std::string::npos)
        << error.what();
    EXPECT_GT(error.problems()[0].place.line, 1);
  }
}

TEST(AxesAlongCuts, NeedControllersThatCountInThem) {
  const std::string name = std::string(SourceDir()) + "/cells/kr500_rail.yaml";
  std::string text = ReadFile(name);
  JobSettings job;
  job.file = "job.yaml";
  job.external.resize(1);
  job.external[0].axis = "rail";
  job.external[0].scope = ExternalScope::kContinuous;
  EXPECT_TRUE(
      CheckAlongCuts(job, ParseCell(text, name)).empty());  // LinuxCNC moves joints, the rail among them
  text.replace(text.find("axis: rail, coupled: true}"), 26, "axis: rail, coupled: false}");
  text.replace(text.find("    ersysroot:"), 14, "    #");
  const CellSettings cell = ParseCell(text, name);
  const std::vector<Problem> problems = CheckAlongCuts(job, cell);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].place.file, "job.yaml");
  EXPECT_NE(
      problems[0].message.find("external[0].scope: given continuous, but krl does not count in axis rail"),
      std::string::npos)
      << problems[0].message;
  job.external[0].scope = ExternalScope::kPerPass;
  EXPECT_TRUE(CheckAlongCuts(job, cell).empty());
  job.external[0].scope = ExternalScope::kContinuous;
  job.programs = {"sinumerik"};
  EXPECT_TRUE(CheckAlongCuts(job, cell).empty());
}

TEST(CellTextsOfACell, MovingCallsStandAtHome) {
  const std::string call =
      "    calls: [{name: WASH, moves: true, from_deg: [0, -90, 90, 0, 0, 0], to_deg: [10, -90, 90, 0, 0, "
      "0]}]\n";
  EXPECT_TRUE(CheckCellTexts(CellWith(call + "    texts: {tool_change: WASH ()}\n").first).empty());
  for (const char* text :
       {"pass_begin: WASH ()", "spindle_on: WASH ()", "footer: \"WASH ()\\nWASH ()\\nWESH ()\""})
    EXPECT_EQ(CheckCellTexts(CellWith(call + fmt::format("    texts: {{{}}}\n", text)).first).size(), 1u)
        << text;
}

TEST(CellTextsOfACell, CallsAreDeclaredInFull) {
  for (const char* call :
       {"{name: WASH, moves: true}", "{name: WASH, moves: true, from_deg: [0, 0, 0, 0, 0, 0]}",
        "{name: WASH, moves: false, to_deg: [0, 0, 0, 0, 0, 0]}", "{name: \"WASH; HALT\", moves: false}",
        "{moves: false}", "{name: WASH}"})
    EXPECT_THROW(CellWith(fmt::format("    calls: [{}]\n", call)), InputError) << call;
}

TEST(CellTextsOfACell, CallsAreNamedAsAssumptions) {
  const CellSettings cell = CellWith(
                                "    calls: [{name: WASH, moves: false}, {name: UNUSED, moves: false}]\n"
                                "    texts: {pass_begin: WASH ()}\n")
                                .first;
  EXPECT_EQ(AssumedCalls(cell, "krl"), std::vector<std::string>{"WASH moves nothing"});
  EXPECT_TRUE(AssumedCalls(cell, "sinumerik").empty());
}

TEST(CellTextsOfACell, WaysToMovingCallsArePlanned) {
  JobInputs inputs;
  inputs.cell = CellWith(
                    "    calls: [{name: WASH, moves: true, from_deg: [20, -90, 90, 0, 0, 0], to_deg: "
                    "[0, -90, 90, 0, 0, 0]}]\n    texts: {header: WASH ()}\n")
                    .first;
  const World world(MakeCell(inputs.cell, {}));
  const std::vector<CallTransition> ways = PlanCallTransitions(world, inputs, "krl", {});
  ASSERT_EQ(ways.size(), 1u);
  EXPECT_EQ(ways[0].call.text, "header");
  EXPECT_LT((ways[0].there.front() - world.cell().home).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((ways[0].there.back() - ways[0].call.from).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(ways[0].back.size(), 1u);  // it ends at home
  EXPECT_TRUE(PlanCallTransitions(world, inputs, "sinumerik", {}).empty());
}

}  // namespace
}  // namespace millpose
