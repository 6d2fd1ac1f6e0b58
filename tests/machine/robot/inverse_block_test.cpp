// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>

#include "machine/robot/inverse_entries.hpp"
#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace {

/// A block of poses: most reached, some singular, some out of reach.
std::array<Pose, kLanes> RandomPoses(const Arm& arm, RandomStream& stream) {
  std::array<Pose, kLanes> poses;
  for (Pose& pose : poses) {
    Joints q = RandomJoints(stream);
    const int kind = stream.Below(20);
    if (kind == 0) q[4] = arm.sign[4] * (0 - arm.offset[4]);
    pose = ForwardFlange(arm, q);
    if (kind == 1) pose.translation() *= 1.5;
    if (kind == 2) pose.translation() = arm.d6 * pose.linear().col(2);  // wrist centre on axis 1
  }
  return poses;
}

const ArmSolution* OnBranch(const InverseResult& result, int branch) {
  for (int s = 0; s < result.count; ++s)
    if (result.solutions[s].branch == branch) return &result.solutions[s];
  return nullptr;
}

/// Lane `i` of entry `b` against the scalar solutions.
void ExpectSame(const Arm& arm, const InverseResult& result, int b, const ArmBranchBlock& block,
                const AnglesBlock& angles, int i) {
  const ArmSolution* held = OnBranch(result, b);
  ASSERT_EQ(block.reached.v[i] != 0, held != nullptr);
  if (held == nullptr) return;
  for (int k = 0; k < 6; ++k) ASSERT_EQ(angles.unflipped[k].v[i], held->q[k]) << k;
  if (EntryCount(arm) == 4) {
    const ArmSolution* flipped = OnBranch(result, b + 4);
    ASSERT_NE(flipped, nullptr);
    for (int k = 0; k < 3; ++k) ASSERT_EQ(angles.unflipped[k].v[i], flipped->q[k]);
    ASSERT_EQ(angles.flipped4.v[i], flipped->q[3]);
    ASSERT_EQ(angles.flipped5.v[i], flipped->q[4]);
    ASSERT_EQ(angles.flipped6.v[i], flipped->q[5]);
  }
  const SingularityDistance distance = DistanceToSingularity(arm, held->q);
  ASSERT_NEAR(block.wrist.v[i], distance.wrist, 1e-12);
  // Near the stretched elbow a rounding of the pose moves the elbow's sine by its root; so does one near the
  // shoulder's singularity where the wrist has an offset.
  ASSERT_NEAR(block.elbow.v[i], distance.elbow, 1e-7);
  ASSERT_NEAR(block.shoulder.v[i], distance.shoulder, 1e-6);
}

TEST(InverseBlock, AgreesWithTheScalarInverseBitForBit) {
  RandomStream stream(1, 0);
  for (const Arm& arm : AllArms()) {
    for (int round = 0; round < 500; ++round) {
      const std::array<Pose, kLanes> poses = RandomPoses(arm, stream);
      FlangeBlock flange;
      for (int i = 0; i < kLanes; ++i) flange.Set(i, poses[i]);
      ArmBranches branches;
      InverseBlock(arm, flange, branches);
      for (int b = 0; b < EntryCount(arm); ++b) {
        AnglesBlock angles;
        AnglesOfBranch(arm, branches[b], angles);
        for (int i = 0; i < kLanes; ++i) ExpectSame(arm, Inverse(arm, poses[i]), b, branches[b], angles, i);
        ASSERT_FALSE(HasFatalFailure()) << arm.name;
      }
    }
  }
}

TEST(InverseBlock, IsFiniteAndTheSameForEveryInstructionSet) {
  RandomStream stream(2, 0);
  for (const Arm& arm : AllArms()) {
    for (int round = 0; round < 200; ++round) {
      FlangeBlock flange;
      const std::array<Pose, kLanes> poses = RandomPoses(arm, stream);
      for (int i = 0; i < kLanes; ++i) flange.Set(i, poses[i]);
      const int entries = EntryCount(arm);
      ArmBranches baseline;
      std::array<AnglesBlock, 8> angles;
      InverseBlock(arm, flange, baseline, InstructionSet::kBaseline);
      for (int b = 0; b < entries; ++b) {
        AnglesOfBranch(arm, baseline[b], angles[b], InstructionSet::kBaseline);
        for (int k = 0; k < 6; ++k) {
          for (int i = 0; i < kLanes; ++i) ASSERT_TRUE(std::isfinite(angles[b].unflipped[k].v[i]));
        }
      }
      for (const InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512}) {
        if (!Supports(set)) continue;
        ArmBranches wide;
        InverseBlock(arm, flange, wide, set);
        ASSERT_EQ(std::memcmp(&wide, &baseline, sizeof(ArmBranchBlock) * entries), 0);
        for (int b = 0; b < entries; ++b) {
          AnglesBlock wide_angles;
          AnglesOfBranch(arm, wide[b], wide_angles, set);
          ASSERT_EQ(std::memcmp(&wide_angles, &angles[b], sizeof(wide_angles)), 0);
        }
      }
    }
  }
}

TEST(InverseEntries, SolvesThoseAskedForAsInverseBlockDoes) {
  RandomStream stream(3, 0);
  for (const Arm& arm : AllArms()) {
    for (int round = 0; round < 100; ++round) {
      FlangeBlock flange;
      const std::array<Pose, kLanes> poses = RandomPoses(arm, stream);
      for (int i = 0; i < kLanes; ++i) flange.Set(i, poses[i]);
      ArmBranches all, some, before;
      InverseBlock(arm, flange, all);
      FlangeBlock other;  // what it leaves in memory would not do
      for (int i = 0; i < kLanes; ++i) other.Set(i, poses[kLanes - 1 - i]);
      InverseBlock(arm, other, some);
      std::memset(static_cast<void*>(&some), 1, sizeof(some));
      before = some;
      const auto entries = static_cast<unsigned>(stream.Below(256));
      InverseEntries(arm, flange, entries, some);
      for (int b = 0; b < 8; ++b) {
        const bool asked = b < EntryCount(arm) && (entries >> b & 1u) != 0;
        ASSERT_EQ(std::memcmp(&some[b], asked ? &all[b] : &before[b], sizeof(ArmBranchBlock)), 0)
            << arm.name << ' ' << b << " of " << entries;
      }
    }
  }
}

}  // namespace
}  // namespace millpose
