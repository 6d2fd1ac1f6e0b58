// SPDX-License-Identifier: GPL-3.0-or-later
// Whole program texts, per controller. After an intended change: MILLPOSE_UPDATE_GOLDEN=1 test_golden, then
// read the difference.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "base/file.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

void ExpectGolden(const std::string& controller, const std::string& folder, const PlanResult& plan,
                  const PostSettings& settings) {
  MotionProgram program = MakeMotionProgram(plan);
  program.frames_checked = controller == "krl";
  const ProgramFiles files = SamplePost(folder)->Write(program, plan.arm, settings);
  for (const auto& [name, text] : files) {
    const std::filesystem::path golden = std::filesystem::path(SourceDir()) / "tests/golden" / folder / name;
    if (std::getenv("MILLPOSE_UPDATE_GOLDEN") != nullptr) {
      std::filesystem::create_directories(golden.parent_path());
      WriteFileAtomically(golden, text);
    }
    EXPECT_EQ(text, ReadFile(golden)) << golden;
  }
}

class Golden : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Variants, Golden,
                         testing::Values("krl", "sinumerik", "sinumerik_euler", "linuxcnc",
                                         "linuxcnc_cartesian"),
                         [](const auto& variant) { return variant.param; });

TEST_P(Golden, WholeText) {
  const PostSettings settings = SampleSettings(GetParam());
  const bool long_one = GetParam() == "krl" || GetParam() == "sinumerik";
  ExpectGolden(ControllerOf(GetParam()), GetParam(),
               SamplePlan({.points = long_one ? 6 : 4, .ring = long_one}), settings);
}

}  // namespace
}  // namespace millpose
