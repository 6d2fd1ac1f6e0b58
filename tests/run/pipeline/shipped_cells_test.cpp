// SPDX-License-Identifier: GPL-3.0-or-later
// Every cell of the project is free of interference with itself where it should be, and not everywhere.
#include "base/random.hpp"
#include "job/assemble.hpp"
#include "machine/collision/world.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

std::vector<std::filesystem::path> Cells() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(SourceDir()) / "cells"))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

class ShippedCell : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(ShippedCell, IsFreeAtHomeAndInMostPosesOfItsWorkingRange) {
  std::map<std::string, std::string> bytes;
  const World world(MakeCell(LoadCell(GetParam(), &bytes), bytes));
  const Arm& arm = world.cell().arm;
  Checker checker(world);
  const auto home = checker.At(world.cell().home, Phase::kFree);
  EXPECT_FALSE(home) << home->first << " " << home->second;

  // Where parts are milled: the arm before itself, bent, the wrist not folded back; inner angles, which are
  // KUKA's up to signs, so that makers who count from an upright arm have the same range.
  RandomStream random(5, 0);
  const auto share = [&](const Joints& lower, const Joints& upper) {
    constexpr int kPoses = 1000;
    int free = 0;
    for (int k = 0; k < kPoses; ++k) {
      Joints q;
      for (int i = 0; i < 6; ++i) q[i] = random.Uniform(lower[i], upper[i]);
      free += !checker.At(q, Phase::kFree);
    }
    return static_cast<double>(free) / kPoses;
  };
  Joints lower, upper;
  lower << -45, -100, 60, -180, -60, -180;
  upper << 45, -50, 115, 180, 60, 180;
  lower *= kRadPerDeg, upper *= kRadPerDeg;
  if (arm.family == ArmFamily::kSphericalWrist)
    for (Eigen::Index i = 0; i < 6; ++i) {
      const double sign = arm.sign[static_cast<size_t>(i)];
      const auto [low, high] =
          std::minmax({sign * (lower[i] - arm.offset[i]), sign * (upper[i] - arm.offset[i])});
      lower[i] = low, upper[i] = high;
    }
  const double working = share(lower, upper), all = share(arm.lower, arm.upper);
  EXPECT_GT(working, 0.9);
  // Over all that the limits allow the arm meets its base, itself and the platform; oftener one with parallel
  // axes, whose joints turn right round.
  EXPECT_GT(all, arm.family == ArmFamily::kParallelAxes ? 0.4 : 0.8);
  EXPECT_LT(all, 0.97);
  RecordProperty("working", std::to_string(working));
  RecordProperty("all", std::to_string(all));
}

INSTANTIATE_TEST_SUITE_P(All, ShippedCell, testing::ValuesIn(Cells()),
                         [](const auto& cell) { return cell.param.stem().string(); });

}  // namespace
}  // namespace millpose
