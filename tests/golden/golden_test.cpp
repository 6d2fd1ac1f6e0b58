// SPDX-License-Identifier: GPL-3.0-or-later
// Whole program texts, per controller. After an intended change: MILLPOSE_UPDATE_GOLDEN=1 test_golden, then
// read the difference.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "base/file.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

void ExpectGolden(const std::string& controller, const std::string& folder, const PlanResult& plan,
                  const PostSettings& settings) {
  const ProgramFiles files = MakePost(controller)->Write(MakeMotionProgram(plan), plan.arm, settings);
  for (const auto& [name, text] : files) {
    const std::filesystem::path golden =
        std::filesystem::path(MILLPOSE_SOURCE_DIR) / "tests/golden" / folder / name;
    if (std::getenv("MILLPOSE_UPDATE_GOLDEN") != nullptr) {
      std::filesystem::create_directories(golden.parent_path());
      WriteFileAtomically(golden, text);
    }
    EXPECT_EQ(text, ReadFile(golden)) << golden;
  }
}

TEST(Golden, Krl) { ExpectGolden("krl", "krl", SamplePlan(), SampleSettings("krl")); }
TEST(Golden, Sinumerik) { ExpectGolden("sinumerik", "sinumerik", SamplePlan(), SampleSettings("sinumerik")); }
TEST(Golden, LinuxCnc) {
  ExpectGolden("linuxcnc", "linuxcnc", SamplePlan({.ring = false}), SampleSettings("linuxcnc"));
}

TEST(Golden, SinumerikEuler) {
  PostSettings settings = SampleSettings("sinumerik");
  settings.rotation = "euler";
  ExpectGolden("sinumerik", "sinumerik_euler", SamplePlan({.points = 3, .ring = false}), settings);
}

}  // namespace
}  // namespace millpose
