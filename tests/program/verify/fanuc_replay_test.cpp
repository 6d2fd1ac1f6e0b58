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

  void Replace(const std::string& from, const std::string& to, int nth = 0) {
    std::string& line = sample.lines[sample.Find(from, nth)];
    line.replace(line.find(from), from.size(), to);
  }
};
INSTANTIATE_TEST_SUITE_P(Frames, FanucReplay, testing::Values("fanuc", "fanuc_held"),
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
    Replace(config, config.substr(0, at) + other + config.substr(at + 5), 0);
    // The first line that has this CONFIG may be another one: all of a cut have the same.
    const std::vector<Finding> findings = Findings();
    ASSERT_FALSE(findings.empty()) << other;
    EXPECT_LE(findings[0].line, motion);
    EXPECT_NE(findings[0].message.find("is stated"), std::string::npos) << findings[0].message;
    sample.lines = lines;
  }
  Replace(numbers, ", 1, 0, 0", 0);
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
    Replace(edit.from, edit.to, edit.from.starts_with("DO") ? 0 : 1);
    try {
      const std::vector<Finding> findings = Findings();
      ASSERT_FALSE(findings.empty()) << edit.to;
      EXPECT_NE(findings[0].message.find(edit.said), std::string::npos) << findings[0].message;
    } catch (const InputError&) {
    }
    sample.lines = lines;
  }
}

}  // namespace
}  // namespace millpose
