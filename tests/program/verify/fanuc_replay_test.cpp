// SPDX-License-Identifier: GPL-3.0-or-later
// LS programs replayed: confirmed as written; CONFIG, turns and positions are held to where the arm arrives.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "program/verify/verify.hpp"
#include "tests/program/program_lines.hpp"
#include "tests/program/verify/sample_cell.hpp"

namespace millpose {
namespace {

class FanucReplay : public testing::TestWithParam<std::string> {
 protected:
  ProgramLines sample{GetParam(), SamplePlan({.wall_turn_deg = -75, .wall_yaw_deg = 12, .tilt_deg = 7})};
  World world{SampleCell(sample.plan)};
  VerifyOptions options = SampleOptions(sample.plan);

  void SetUp() override {
    options.max_corner = sample.settings.max_corner.value_or(0);
    sample.files = sample.post->Write(Prepared(sample.program, GetParam(), sample.settings, sample.plan.arm),
                                      sample.plan.arm, sample.settings);
    sample.lines.clear();
    const std::string& text = sample.files.begin()->second;
    for (size_t begin = 0; begin < text.size(); begin = text.find('\n', begin) + 1)
      sample.lines.push_back(text.substr(begin, text.find('\n', begin) - begin));
  }

  std::vector<Finding> Findings() const {
    MotionProgram read = sample.Read();
    if (!read.X_BP) read.X_BP = sample.program.X_BP;
    if (!read.X_FT) read.X_FT = sample.program.X_FT;
    return Verify(read, world, &sample.program, options, {.threads = 1});
  }

  /// In the nth line that holds it; false where none does.
  bool Replace(const std::string& from, const std::string& to, int nth = 0) {
    for (std::string& line : sample.lines) {
      const size_t at = line.find(from);
      if (at == std::string::npos || nth-- > 0) continue;
      line.replace(at, from.size(), to);
      return true;
    }
    return false;
  }
};
INSTANTIATE_TEST_SUITE_P(Frames, FanucReplay, testing::Values("fanuc", "fanuc_held", "fanuc_cnt", "fanuc_cr"),
                         [](const auto& variant) { return variant.param; });

TEST_P(FanucReplay, IsConfirmedAsWritten) {
  const std::vector<Finding> findings = Findings();
  EXPECT_TRUE(findings.empty()) << findings[0].line << ": " << findings[0].message;
}

TEST_P(FanucReplay, AnotherConfigurationOrTurnIsFoundAtItsMotion) {
  const std::string config = sample.lines[sample.Find("CONFIG", 5)];
  const size_t at = config.find('\'') + 1;
  const std::string letters = config.substr(at, 5), numbers = config.substr(at + 5, 9);
  const char flipped = letters[0] == 'F' ? 'N' : 'F', bent = letters[2] == 'U' ? 'D' : 'U',
             reached = letters[4] == 'T' ? 'B' : 'T';
  const int motion = static_cast<int>(sample.Find(":L P", 5)) + 1;
  for (const std::string& other : {std::string{flipped, ' ', letters[2], ' ', letters[4]},
                                   std::string{letters[0], ' ', bent, ' ', letters[4]},
                                   std::string{letters[0], ' ', letters[2], ' ', reached}}) {
    const std::vector<std::string> lines = sample.lines;
    ASSERT_TRUE(Replace(config, config.substr(0, at) + other + config.substr(at + 5)));
    // The first line that has this CONFIG may be another one: all of a cut have the same.
    const std::vector<Finding> findings = Findings();
    ASSERT_FALSE(findings.empty()) << other;
    EXPECT_LE(findings[0].line, motion);
    EXPECT_NE(findings[0].message.find("is stated"), std::string::npos) << findings[0].message;
    sample.lines = lines;
  }
  ASSERT_TRUE(Replace(numbers, ", 1, 0, 0"));
  const std::vector<Finding> findings = Findings();
  ASSERT_FALSE(findings.empty());
  EXPECT_NE(findings[0].message.find("180 to 540 deg are stated"), std::string::npos) << findings[0].message;
}

TEST_P(FanucReplay, WhatMattersIsFound) {
  struct TextChange {
    std::string from, to, said;
  };
  for (const TextChange& edit : std::vector<TextChange>{{"8cm/min", "9cm/min", "mm/min"},
                                                        {"8cm/min", "3cm/min", "mm/min"},
                                                        {"CNT0", "FINE", "stop"},
                                                        {"DO[1]=OFF", "DO[2]=OFF", ""},
                                                        {"    X = ", "    X = 1", ""}}) {
    const std::vector<std::string> lines = sample.lines;
    const bool found = Replace(edit.from, edit.to, edit.from.starts_with("DO") ? 0 : 1);
    EXPECT_TRUE(found || (edit.from == "CNT0" && GetParam() == "fanuc_cnt")) << edit.from;
    if (!found) continue;
    try {
      const std::vector<Finding> findings = Findings();
      ASSERT_FALSE(findings.empty()) << edit.to;
      EXPECT_NE(findings[0].message.find(edit.said), std::string::npos) << findings[0].message;
    } catch (const InputError&) {
    }
    sample.lines = lines;
  }
}

/// How often a motion of `text` ends with a word that begins so.
size_t CountOf(const std::string& text, const std::string& word) {
  size_t count = 0;
  for (size_t at = text.find(" " + word); at != std::string::npos; at = text.find(" " + word, at + 1))
    ++count;
  return count;
}

TEST(FanucCorners, AreConfirmedWithinTheBoundThatTheCellAllows) {
  for (const std::string variant : {"fanuc_cnt", "fanuc_cr"}) {
    const PlanResult plan = SamplePlan({.points = 40});
    const ProgramLines sample(variant, plan);
    const std::string& text = sample.files.begin()->second;
    EXPECT_GT(CountOf(text, variant == "fanuc_cnt" ? "CNT100" : "CR"), 30u) << variant;
    const World world{SampleCell(plan)};
    VerifyOptions options = SampleOptions(plan);
    options.max_corner = *sample.settings.max_corner;
    const MotionProgram read = sample.Read();
    EXPECT_FALSE(read.corner_assumption.empty());
    const std::vector<Finding> findings = Verify(read, world, &sample.program, options, {.threads = 1});
    EXPECT_TRUE(findings.empty()) << variant << ": " << findings[0].line << ": " << findings[0].message;
    // What reaches farther is found where the path bends.
    MotionProgram wider = read;
    for (Motion& motion : wider.motions) motion.blend *= 50;
    const std::vector<Finding> wide = Verify(wider, world, &sample.program, options, {.threads = 1});
    ASSERT_FALSE(wide.empty()) << variant;
    EXPECT_EQ(wide[0].cause, Cause::kCorner) << wide[0].message;
  }
}

TEST(FanucCorners, WithoutWhatBoundsThemAreRefused) {
  const auto refused = [](const std::string& variant, const std::string& from, const std::string& to) {
    ProgramLines sample(variant, SamplePlan({.points = 40}));
    std::string& line = sample.lines[sample.Find(from)];
    line.replace(line.find(from), from.size(), to);
    return !sample.Problems().empty();
  };
  EXPECT_TRUE(refused("fanuc", "CNT0", "CNT100"));
  EXPECT_TRUE(refused("fanuc", "CNT0", "CR1"));
  EXPECT_TRUE(refused("fanuc_cr", "min CR", "min CNT"));
  EXPECT_TRUE(refused("fanuc_cnt", "CNT100", "CR1"));
  EXPECT_TRUE(refused("fanuc_cnt", "CNT100", "CNT101"));
  EXPECT_FALSE(refused("fanuc_cnt", "CNT100", "CNT50"));
}

}  // namespace
}  // namespace millpose
