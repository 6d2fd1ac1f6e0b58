// SPDX-License-Identifier: GPL-3.0-or-later
// A controller that a program brings along: its keys are read, written and told like those of the library's.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "job/config/config.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/program/own_options.hpp"

namespace millpose {
namespace {

class PlainPost final : public Post {
 public:
  struct Options {
    int spindle_port = 1;
  };
  explicit PlainPost(Options options) : options_(options) {}
  const Options& options() const { return options_; }

  std::string Name() const override { return "plain"; }
  std::vector<std::string> Endings() const override { return {".txt"}; }
  void Round(MotionProgram&, const Arm&, const PostSettings&) const override {}
  double UsualCycle() const override { return 0.002; }
  ProgramFiles Write(const MotionProgram&, const Arm&, const PostSettings&) const override { return {}; }
  MotionProgram Read(const ProgramFiles&, const Arm&, const PostSettings&) const override { return {}; }
  CallingSyntax Calling() const override { return {.ending = ".txt", .call = "{name}\n"}; }
  std::vector<Problem> CheckTexts(const Arm&, const PostSettings&) const override { return {}; }

 private:
  Options options_;
};

// Before the first job is read.
const bool kAdded = [] {
  Posts().Add(EntryOf<PlainPost>(
      {ToolAxisKey(), yaml::Key<PlainPost::Options>("spindle_port", MILLPOSE_AT(spindle_port),
                                                    yaml::Integer(1, 9), "Where the spindle is wired.")}));
  return true;
}();

/// A cell up to its last section.
std::string CellHead() {
  const std::string cell = ReadFile(std::filesystem::path(SourceDir()) / "cells/kr500_r2830.yaml");
  return cell.substr(0, cell.find("\ncontrollers:\n")) + "\ncontrollers:\n";
}

CellSettings CellOf(const std::string& controllers) {
  return ParseCell(CellHead() + controllers, "cell.yaml");
}

std::vector<Problem> ProblemsOf(const std::string& controllers) {
  try {
    CellOf(controllers);
  } catch (const InputError& error) {
    return error.problems();
  }
  return {};
}

TEST(OwnController, ItsKeysAreReadAndWritten) {
  ASSERT_TRUE(kAdded);
  const CellSettings cell = CellOf("  plain: {tool_axis: -y, spindle_port: 7}\n");
  EXPECT_EQ(cell.controllers.at("plain").shared.tool_axis, FrameAxis::kMinusY);
  EXPECT_EQ(OwnOptions<PlainPost>(cell.controllers.at("plain")).spindle_port, 7);
  const CellSettings again = ParseCell(WriteCell(cell), "written");
  EXPECT_EQ(OwnOptions<PlainPost>(again.controllers.at("plain")).spindle_port, 7);
  EXPECT_EQ(OwnOptions<PlainPost>(CellOf("  plain: {}\n").controllers.at("plain")).spindle_port, 1);
}

TEST(OwnController, SlipsAreToldWithTheirPlace) {
  for (
      const auto& [text, message] :
      {std::pair{"  plain:\n    spindle_prt: 7\n",
                 "controllers.plain.spindle_prt: unknown key; nearest known key: spindle_port"},
       {"  plain:\n    spindle_port: 10\n", "controllers.plain.spindle_port: given 10; allowed: integer 1…9"},
       {"  krl:\n    spindle_port: 7\n",
        "controllers.krl.spindle_port: krl programs do not know this; allowed for: plain"},
       {"  plain:\n    advance: 2\n",
        "controllers.plain.advance: plain programs do not know this; allowed for: krl"},
       {"  plain:\n    max_motions: 50\n",
        "controllers.plain.max_motions: plain programs do not know this; allowed for: krl, sinumerik, fanuc, "
        "rapid"}}) {
    const std::vector<Problem> problems = ProblemsOf(text);
    ASSERT_EQ(problems.size(), 1u) << text;
    EXPECT_EQ(problems[0].message, message);
    EXPECT_EQ(problems[0].place.line, std::ranges::count(CellHead(), '\n') + 2);
  }
}

TEST(OwnController, SchemasOfferIt) {
  const auto cell = nlohmann::json::parse(CellSchema());
  const auto& keys = cell["properties"]["controllers"]["properties"]["plain"]["properties"];
  EXPECT_EQ(keys.size(), 2u);
  EXPECT_EQ(keys["spindle_port"]["default"], 1);
  EXPECT_EQ(keys["spindle_port"]["maximum"], 9);
  const auto job = nlohmann::json::parse(JobSchema());
  const auto& offered = job["properties"]["programs"]["items"]["enum"];
  EXPECT_NE(std::ranges::find(offered, "plain"), offered.end());
}

}  // namespace
}  // namespace millpose
