// SPDX-License-Identifier: GPL-3.0-or-later
// Jobs of several operations, and which tool of a cell a job takes.
#include "base/error.hpp"
#include "base/file.hpp"
#include "job/config/config.hpp"
#include "program/program_name.hpp"
#include "tests/base/refusal.hpp"
#include "tests/base/replaced.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

const std::string kWallJob = R"(millpose_job: 1
name: wall
cell: cell.yaml
tool: mill
workpiece: {mesh: part.stl, unit: mm, pose: {xyz_mm: [1, 2, 3]}}
process: {spindle_rpm: 7000, feed_mm_min: 100}
limits: {margin_deg: 5}
operations:
  - name: rough
    toolpath: {strategy: parallel_planes, planes: {normal: [0, 1, 0]}, stepover_mm: 8, depth: {total_mm: 6, per_layer_mm: 2}}
  - name: finish
    tool: ball
    process: {feed_mm_min: 300}
    limits: {margin_deg: 7}
    toolpath: {strategy: parallel_planes, planes: {normal: [1, 0, 0]}, stepover_mm: 2}
programs: [krl]
)";

/// What a text is refused with; "accepted" where it is not.
std::string JobRefusal(const std::string& text, std::optional<size_t> operation = 0) {
  return RefusalOf([&] { ParseJob(text, "job.yaml", {}, operation); });
}

TEST(Operations, HaveTheJobsKeysWhereTheyGiveNone) {
  const JobSettings rough = ParseJob(kWallJob, "job.yaml", {}, 0),
                    finish = ParseJob(kWallJob, "job.yaml", {}, 1);
  EXPECT_EQ(rough.name, OperationName("wall", "rough"));
  EXPECT_EQ(rough.operation_of, "wall");
  EXPECT_EQ(finish.name, OperationName("wall", "finish"));
  EXPECT_EQ(rough.operation, "rough");
  EXPECT_EQ(finish.operation, "finish");
  EXPECT_EQ(rough.tool, "mill");
  EXPECT_EQ(finish.tool, "ball");
  EXPECT_DOUBLE_EQ(rough.feed * 60, 100);
  EXPECT_DOUBLE_EQ(finish.feed * 60, 300);
  for (const JobSettings* job : {&rough, &finish}) EXPECT_DOUBLE_EQ(job->spindle_speed * 60, 7000);
  EXPECT_DOUBLE_EQ(RadToDeg(rough.limit_margin), 5);
  EXPECT_DOUBLE_EQ(RadToDeg(finish.limit_margin), 7);
  EXPECT_EQ(rough.toolpath.stepover, 8);
  EXPECT_EQ(finish.toolpath.stepover, 2);
  EXPECT_EQ(finish.toolpath.layers.total, 0) << "a tool path of its own has nothing of another's";
}

TEST(Operations, WhatALaterOneTakesOffIsOnThePartUntilThen) {
  const std::string deep_last =
      Replaced(Replaced(kWallJob, ", depth: {total_mm: 6, per_layer_mm: 2}", ""), "stepover_mm: 2}",
               "stepover_mm: 2, depth: {total_mm: 4, per_layer_mm: 2}}");
  EXPECT_EQ(ParseJob(deep_last, "job.yaml", {}, 0).workpiece.allowance, 4);
  EXPECT_FALSE(ParseJob(deep_last, "job.yaml", {}, 1).workpiece.allowance);
  EXPECT_FALSE(ParseJob(kWallJob, "job.yaml", {}, 0).workpiece.allowance) << "its own depth";
  const std::string stated = Replaced(deep_last, "unit: mm,", "unit: mm, allowance_mm: 1,");
  EXPECT_EQ(ParseJob(stated, "job.yaml", {}, 0).workpiece.allowance, 1);
}

// --set and batches' `set` name an operation's key by the operation's name; other names are told.
TEST(Operations, AreSetByName) {
  const std::string name = OutlineOf(kWallJob, "job.yaml").operations.at(1);
  const Override change = ParseOverride("operations." + name + ".process.feed_mm_min=321");
  EXPECT_DOUBLE_EQ(ParseJob(kWallJob, "job.yaml", {change}, 1).feed, 321.0 / 60);
  EXPECT_NE(ParseJob(kWallJob, "job.yaml", {change}, 0).feed, 321.0 / 60);
  const std::string refusal = RefusalOf(
      [&] { ParseJob(kWallJob, "job.yaml", {ParseOverride("operations.nobody.process.feed_mm_min=3")}, 0); });
  EXPECT_NE(refusal.find("no entry is called nobody; allowed: "), std::string::npos) << refusal;
  EXPECT_NE(refusal.find(name), std::string::npos) << refusal;
}

TEST(Operations, AnOutlineNamesThem) {
  const JobOutline outline = OutlineOf(kWallJob, "job.yaml");
  EXPECT_EQ(outline.name, "wall");
  EXPECT_EQ(outline.operations, (std::vector<std::string>{"rough", "finish"}));
  EXPECT_TRUE(OutlineOf("millpose_job: 1\nname: one\n", "job.yaml").operations.empty());
}

TEST(Operations, OneAtATimeIsReadAndTheErrorSaysSo) {
  EXPECT_TRUE(JobRefusal(kWallJob, std::nullopt)
                  .starts_with("job.yaml:8:1: operations: given 2; one at a time allowed"));
}

TEST(Operations, EachIsCheckedWhicheverIsAskedFor) {
  const std::string wrong = Replaced(kWallJob, "stepover_mm: 2", "stepover_mm: -2");
  for (const size_t asked : {0u, 1u})
    EXPECT_EQ(JobRefusal(wrong, asked),
              "job.yaml:15:85: toolpath.stepover_mm: given -2; allowed: number 0.001…10000, mm");
  // What is wrong in the job's own sections is reported once.
  EXPECT_EQ(JobRefusal(Replaced(kWallJob, "spindle_rpm: 7000", "spindle_rpm: x")),
            "job.yaml:6:24: process.spindle_rpm: given x; allowed: number 0…500000, rev/min (written like 1, "
            "1.5 or 1e-5)");
}

TEST(Operations, NamesAndKeysAreChecked) {
  const auto refused = [](const std::string& from, const std::string& to) {
    return JobRefusal(Replaced(kWallJob, from, to));
  };
  EXPECT_EQ(refused("name: finish", "name: rough"), "job.yaml:11:11: operations[1].name: given rough twice");
  EXPECT_TRUE(
      refused("name: finish", "name: 2nd pass").starts_with("job.yaml:11:11: operations[1].name: given"));
  EXPECT_TRUE(refused("    tool: ball\n", "    tol: ball\n")
                  .starts_with("job.yaml:12:5: operations[1].tol: unknown key; nearest known key: tool"));
  EXPECT_TRUE(refused("    tool: ball\n", "    programs: [krl]\n")
                  .starts_with("job.yaml:12:5: operations[1].programs"));
  EXPECT_TRUE(refused("  - name: rough\n    toolpath:", "  - toolpath:")
                  .starts_with("job.yaml:9:5: operations[0].name: missing"));
}

TEST(Operations, AKeyThatAllOfThemHaveOtherwiseHasNoEffect) {
  EXPECT_EQ(JobRefusal(Replaced(kWallJob, "  - name: rough\n", "  - name: rough\n    tool: saw\n")),
            "job.yaml:4:1: tool has no effect here: every operation has its own");
  EXPECT_EQ(
      JobRefusal(Replaced(kWallJob, "  - name: rough\n", "  - name: rough\n    limits: {margin_deg: 1}\n")),
      "job.yaml:7:10: limits.margin_deg has no effect here: every operation has its own");
}

TEST(Operations, WhatIsNoListOfMapsIsRefused) {
  const std::string head = kWallJob.substr(0, kWallJob.find("operations:"));
  for (const char* given : {"[]", "{}", "7", "[1]", "[{}]", "[[]]"})
    EXPECT_TRUE(JobRefusal(head + "operations: " + given + "\n").starts_with("job.yaml:8:")) << given;
  std::string many = head + "operations:\n";
  for (int i = 0; i < 100; ++i) many += fmt::format("  - name: o{}\n", i);
  EXPECT_NE(JobRefusal(many).find("a list of 1 to 99 operations"), std::string::npos);
}

TEST(Operations, TheResolvedFileOfOneReadsBackToItself) {
  for (const size_t i : {0u, 1u}) {
    const std::string written = WriteJob(ParseJob(kWallJob, "job.yaml", {}, i));
    EXPECT_EQ(WriteJob(ParseJob(written, "job.yaml")), written);
  }
}

CellSettings TwoTools() {
  const auto file = std::filesystem::path(SourceDir()) / "cells/kr500_two_tools.yaml";
  return ParseCell(ReadFile(file), file.string());
}

TEST(SelectTool, TakesTheToolThatTheJobNames) {
  for (const char* name : {"mill_d20", "drill_d5"}) {
    CellSettings cell = TwoTools();
    SelectTool(name, &cell);
    EXPECT_EQ(cell.tool.name, name);
    EXPECT_EQ(cell.tools.size(), TwoTools().tools.size());
  }
  CellSettings one;
  one.tool.name = "mill";
  SelectTool("", &one);
  SelectTool("mill", &one);
  EXPECT_EQ(one.tool.name, "mill");
}

TEST(SelectTool, WhatIsNotThereOrNotClearIsNamed) {
  CellSettings cell = TwoTools();
  const auto refused = [&](const std::string& name) -> std::string {
    try {
      SelectTool(name, &cell);
      return "accepted";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refused(""),
            fmt::format("tool: missing; cell {} has several, allowed: mill_d20, drill_d5", cell.name));
  EXPECT_EQ(refused("drill_d6"), fmt::format("tool: given drill_d6; allowed, the tools of cell {}: mill_d20, "
                                             "drill_d5; did you mean drill_d5?",
                                             cell.name));
}

}  // namespace
}  // namespace millpose
