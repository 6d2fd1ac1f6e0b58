// SPDX-License-Identifier: GPL-3.0-or-later
// Own sources' options: this file is compiled as lib/'s are, not as millpose_lane_sources; bits must not
// differ.
#include "base/lanes.hpp"

#include "base/cpu_time.hpp"
#include "base/random.hpp"
#include "base/rotation.hpp"
#include "base/trig.hpp"

namespace millpose {
namespace {

Lanes RandomLanes(RandomStream& random, double most) {
  Lanes lanes;
  for (double& value : lanes.v) value = random.Uniform(-most, most);
  return lanes;
}

TEST(Lanes, EveryInstructionSetGivesTheBitsOfScalarCode) {
  RandomStream random(3, 0);
  for (int round = 0; round < 200; ++round) {
    const Lanes a = RandomLanes(random, 100), b = RandomLanes(random, 1e-3);
    const auto value = [](double x, double y) {
      const SineCosine turn = SinCos(x);
      return Atan2(turn.sin * y + x, turn.cos) + x * y;
    };
    for (const InstructionSet set :
         {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512}) {
      if (!Supports(set)) continue;
      Lanes out;
      ForEachLane(
          set, [&](int i) __attribute__((always_inline)) { out.v[i] = value(a.v[i], b.v[i]); });
      for (int i = 0; i < kLanes; ++i)
        ASSERT_EQ(std::bit_cast<uint64_t>(out.v[i]), std::bit_cast<uint64_t>(value(a.v[i], b.v[i])));
    }
  }
}

TEST(Lanes, TheBaselineIsAlwaysThereAndTheWidestSetIsOneThatIs) {
  EXPECT_TRUE(Supports(InstructionSet::kBaseline));
  EXPECT_TRUE(Supports(WidestInstructionSet()));
}

TEST(RotationAbout, IsARotationThatKeepsItsAxisAndAddsItsAngles) {
  RandomStream random(4, 0);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector3d axis =
        Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
    const double a = random.Uniform(-10, 10), b = random.Uniform(-10, 10);
    const Eigen::Matrix3d R = RotationAbout(axis, a);
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_NEAR(R.determinant(), 1, 1e-14);
    EXPECT_LT((R * axis - axis).norm(), 1e-15);
    EXPECT_LT((R * RotationAbout(axis, b) - RotationAbout(axis, a + b)).norm(), 1e-14);
    EXPECT_LT((R - Eigen::AngleAxisd(a, axis).toRotationMatrix()).norm(), 1e-14);
  }
}

/// Seconds of CPU that this thread has taken, spent on purpose.
void Burn(double seconds) {
  const double until = ProcessCpuSeconds() + seconds;
  while (ProcessCpuSeconds() < until) {
  }
}

TEST(CpuTimer, CountsForTheInnermostPartAlone) {
  const auto before = CpuSeconds();
  {
    const CpuTimer outer(CpuPart::kOptima);
    Burn(0.01);
    {
      const CpuTimer inner(CpuPart::kInterference);
      Burn(0.03);
    }
    Burn(0.01);
  }
  Burn(0.02);  // outside of all
  const auto after = CpuSeconds();
  const auto spent = [&](CpuPart part) {
    return after[static_cast<size_t>(part)] - before[static_cast<size_t>(part)];
  };
  EXPECT_NEAR(spent(CpuPart::kOptima), 0.02, 0.008);
  EXPECT_NEAR(spent(CpuPart::kInterference), 0.03, 0.008);
  EXPECT_EQ(spent(CpuPart::kOther), 0);
}

}  // namespace
}  // namespace millpose
