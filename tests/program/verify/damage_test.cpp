// SPDX-License-Identifier: GPL-3.0-or-later
// Every damage that changes motion, timing or outputs is caught with its line; harmless edits pass.
#include "tests/program/verify/damage.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "program/controller_axes.hpp"
#include "program/verify/confirmed_runs.hpp"
#include "tests/program/verify/same_motions.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {
namespace {

MotionProgram WithOutputs(const PlanResult& plan) {
  MotionOptions options;
  options.outputs = {{5, true, 0, true}, {5, false, 0, false}};
  return MakeMotionProgram(plan, options);
}

class DamagedProgram : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Post> post = SamplePost(GetParam());
  PostSettings settings = SampleSettings(GetParam());
  PlanResult plan = SamplePlan({.wall_turn_deg = -75, .wall_yaw_deg = 12, .tilt_deg = 7});
  MotionProgram program = WithOutputs(plan);
  World world{SampleCell(plan)};
  VerifyOptions options = SampleOptions(plan);
  ProgramFiles files = post->Write(Prepared(program, GetParam(), settings, plan.arm), plan.arm, settings);
  std::string name = files.rbegin()->first;  // .src comes after .dat
  std::string text = WithWholeLines(files.rbegin()->second);
  MotionProgram as_written = post->Read(files, plan.arm, settings);

  void SetUp() override { options.written = &as_written; }

  bool Applies(const TextEdit& edit) const {
    const std::string controller = ControllerOf(GetParam());
    const std::string letters = controller == "krl"                  ? "K"
                                : controller == "sinumerik"          ? "S"
                                : GetParam() == "linuxcnc_cartesian" ? "LC"
                                                                     : "L";
    return edit.controllers.find_first_of(letters) != std::string::npos;
  }
  /// Edits are made for the plain variants; another may have nothing that fits.
  bool MayHaveNothing() const { return GetParam() != ControllerOf(GetParam()); }

  MotionProgram Read(const std::string& edited) const {
    ProgramFiles other = files;
    other[name] = edited;
    return post->Read(other, plan.arm, settings);
  }

  /// The first line that differs from the written text.
  int FirstChange(const std::string& edited) const {
    int line = 1;
    for (size_t i = 0; i < std::min(text.size(), edited.size()) && text[i] == edited[i]; ++i) {
      if (text[i] == '\n') ++line;
    }
    return line;
  }
};
INSTANTIATE_TEST_SUITE_P(Controllers, DamagedProgram,
                         testing::Values("krl", "sinumerik", "sinumerik_euler", "linuxcnc",
                                         "linuxcnc_cartesian"),
                         [](const auto& controller) { return controller.param; });

TEST_P(DamagedProgram, IsCaughtWithItsLine) {
  const MotionProgram written = Read(text);
  int kinds = 0;
  for (const TextEdit& damage : Damages()) {
    if (!Applies(damage)) continue;
    const std::optional<std::string> edited = damage.apply(text);
    EXPECT_TRUE(edited || MayHaveNothing()) << damage.name << " edits nothing";
    if (!edited) continue;
    ++kinds;
    try {
      const MotionProgram read = Read(*edited);
      const std::vector<Finding> findings = Verify(read, world, &program, options, {.threads = 2});
      if (findings.empty()) {
        EXPECT_TRUE(SameMotions(written, read, plan)) << damage.name << " is not caught";
        continue;
      }
      for (const Finding& finding : findings) {
        EXPECT_EQ(finding.file, name) << damage.name;
        EXPECT_GT(finding.line, 0) << damage.name << ": " << finding.message;
      }
      // Said where it is, or where it first shows: not before the motion that leads to the changed line.
      EXPECT_GE(findings.front().line, FirstChange(*edited) - 4)
          << damage.name << ": " << findings.front().message;
    } catch (const InputError& error) {
      EXPECT_GT(error.problems().front().place.line, 0) << damage.name;
    }
  }
  EXPECT_GE(kinds, 40);
}

TEST(ConfirmedRuns, AreOfAnotherContextWhereAnythingIsAskedOtherwise) {
  VerifyOptions asked;
  asked.lower.setConstant(-2), asked.upper.setConstant(2);
  const std::string context = ConfirmedRuns::ContextOf(asked);
  EXPECT_EQ(ConfirmedRuns::ContextOf(asked), context);
  using O = VerifyOptions;
  for (double O::*const number :
       {&O::position_tolerance, &O::angle_tolerance, &O::max_corner, &O::step, &O::swept_resolution,
        &O::clearance_reserve, &O::feed_least, &O::feed_most, &O::gap_tolerance, &O::gap_proven,
        &O::jump_time, &O::feed_jump, &O::wrist_least}) {
    VerifyOptions other = asked;
    other.*number *= 1.5, other.*number += 1e-3;
    EXPECT_NE(ConfirmedRuns::ContextOf(other), context);
  }
  VerifyOptions lower = asked, upper = asked, coupled = asked;
  lower.lower[3] -= 0.1, upper.upper[5] += 0.1;
  coupled.coupled.emplace_back();
  for (const VerifyOptions& other : {lower, upper, coupled})
    EXPECT_NE(ConfirmedRuns::ContextOf(other), context);
}

// Where cuts were confirmed before, a damaged program has the findings that it has by itself.
TEST_P(DamagedProgram, IsCaughtLikewiseWhereItsCutsWereConfirmed) {
  ConfirmedRuns confirmed;
  VerifyOptions knowing = options;
  knowing.confirmed = &confirmed;
  for (int again = 0; again < 2; ++again) {
    EXPECT_TRUE(Verify(Read(text), world, &program, knowing, {.threads = 2}).empty());
    EXPECT_EQ(confirmed.found(), again * FeedRuns(as_written).size());
  }
  ConfirmedRuns later;  // of another process, which knows what the first has left
  later.Know(confirmed.Used());
  knowing.confirmed = &later;
  std::vector<TextEdit> edits = Damages();
  std::ranges::copy(HarmlessEdits(), std::back_inserter(edits));
  for (const TextEdit& edit : edits) {
    const std::optional<std::string> edited = Applies(edit) ? edit.apply(text) : std::nullopt;
    if (!edited) continue;
    try {
      const MotionProgram read = Read(*edited);
      const auto plain = Verify(read, world, &program, options, {.threads = 2});
      const auto shortened = Verify(read, world, &program, knowing, {.threads = 2});
      ASSERT_EQ(shortened.size(), plain.size()) << edit.name;
      for (size_t i = 0; i < plain.size(); ++i) {
        EXPECT_EQ(shortened[i].line, plain[i].line) << edit.name;
        EXPECT_EQ(shortened[i].message, plain[i].message) << edit.name;
      }
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(later.found(), 0u) << "cuts that an edit leaves as they were";
}

TEST_P(DamagedProgram, SubprogramsInAnotherOrderAreCaught) {
  if (ControllerOf(GetParam()) == "linuxcnc") return;  // one file
  settings.max_motions = 12;
  ProgramFiles parts = post->Write(Prepared(program, GetParam(), settings, plan.arm), plan.arm, settings);
  const std::string extension = ControllerOf(GetParam()) == "krl" ? ".src" : ".mpf";
  std::string& main = parts.at("Sample_wall_plan" + extension);
  const size_t first = main.find("_001"), second = main.find("_002");
  ASSERT_NE(second, std::string::npos);
  EXPECT_TRUE(
      Verify(post->Read(parts, plan.arm, settings), world, &program, options, {.threads = 2}).empty());
  main[first + 3] = '2';
  main[second + 3] = '1';
  const std::vector<Finding> findings =
      Verify(post->Read(parts, plan.arm, settings), world, &program, options, {.threads = 2});
  ASSERT_FALSE(findings.empty());
  EXPECT_GT(findings.front().line, 0);
  // One call twice and the other lost.
  main[second + 3] = '2';
  EXPECT_THROW(post->Read(parts, plan.arm, settings), InputError);
}

TEST_P(DamagedProgram, HarmlessEditsPass) {
  int kinds = 0;
  for (const TextEdit& edit : HarmlessEdits()) {
    if (!Applies(edit)) continue;
    const std::optional<std::string> edited = edit.apply(text);
    EXPECT_TRUE(edited || MayHaveNothing()) << edit.name;
    if (!edited) continue;
    ++kinds;
    try {
      for (const Finding& finding : Verify(Read(*edited), world, &program, options, {.threads = 2})) {
        ADD_FAILURE() << edit.name << ": " << finding.line << ": " << finding.message;
      }
    } catch (const InputError& error) {
      ADD_FAILURE() << edit.name << ": " << error.what();
    }
  }
  EXPECT_GE(kinds, 10);
}

}  // namespace
}  // namespace millpose
