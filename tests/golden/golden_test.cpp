// SPDX-License-Identifier: GPL-3.0-or-later
// Whole program texts, per controller. After an intended change: MILLPOSE_UPDATE_GOLDEN=1 test_golden, then
// read the difference.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "base/file.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/program/station_plan.hpp"

namespace millpose {
namespace {

void ExpectGolden(const std::string& controller, const std::string& folder, const PlanResult& plan,
                  const Post& post, const PostSettings& settings) {
  MotionProgram program = MakeMotionProgram(plan);
  program.frames_checked = controller == "krl";
  const ProgramFiles files = post.Write(program, plan.arm, settings);
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
                                         "linuxcnc_cartesian", "urscript", "fanuc", "fanuc_held", "rapid"),
                         [](const auto& variant) { return variant.param; });

TEST_P(Golden, WholeText) {
  const PostSettings settings = SampleSettings(GetParam());
  const bool long_one =
      GetParam() == "krl" || GetParam() == "sinumerik" || GetParam() == "fanuc" || GetParam() == "rapid";
  ExpectGolden(ControllerOf(GetParam()), GetParam(),
               SamplePlan({.points = long_one ? 6 : 4, .ring = long_one}), *SamplePost(GetParam()), settings);
}

struct Carried {
  const char *variant, *axes;
  bool coupled;
};

class GoldenStations : public testing::TestWithParam<Carried> {};
INSTANTIATE_TEST_SUITE_P(Variants, GoldenStations,
                         testing::Values(Carried{"krl", "rail", true}, Carried{"krl", "table", true},
                                         Carried{"krl", "table", false}, Carried{"sinumerik", "rail", false},
                                         Carried{"linuxcnc", "both", false}, Carried{"rapid", "both", true}));

TEST_P(GoldenStations, WholeText) {
  const auto [variant, axes, coupled] = GetParam();
  const PlanResult plan = StationPlan(axes);
  const StationPost post(variant, plan, coupled);
  ExpectGolden(variant, fmt::format("stations/{}_{}{}", variant, axes, coupled ? "_coupled" : ""), plan,
               *post.post, post.settings);
}

}  // namespace
}  // namespace millpose
