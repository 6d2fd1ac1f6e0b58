// SPDX-License-Identifier: GPL-3.0-or-later
#include "robot/inverse_block.hpp"

#include <cstring>

#include "tests/robot/arms.hpp"

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

TEST(InverseBlock, AgreesWithTheScalarInverseBitForBit) {
  RandomStream stream(1, 0);
  for (const Arm& arm : AllArms()) {
    for (int round = 0; round < 500; ++round) {
      const std::array<Pose, kLanes> poses = RandomPoses(arm, stream);
      FlangeBlock flange;
      for (int i = 0; i < kLanes; ++i) flange.Set(i, poses[i]);
      ArmBranches branches;
      InverseBlock(arm, flange, branches);
      for (int b = 0; b < 4; ++b) {
        AnglesBlock angles;
        AnglesOfBranch(arm, branches[b], angles);
        for (int i = 0; i < kLanes; ++i) {
          std::array<const ArmSolution*, 2> scalar{};
          const InverseResult result = Inverse(arm, poses[i]);
          for (int s = 0; s < result.count; ++s) {
            if (result.solutions[s].branch % 4 == b)
              scalar[result.solutions[s].branch / 4] = &result.solutions[s];
          }
          ASSERT_EQ(branches[b].reached.v[i] != 0, scalar[0] != nullptr);
          if (scalar[0] == nullptr) continue;
          for (int k = 0; k < 6; ++k) ASSERT_EQ(angles.unflipped[k].v[i], scalar[0]->q[k]) << arm.name << k;
          for (int k = 0; k < 3; ++k) ASSERT_EQ(angles.unflipped[k].v[i], scalar[1]->q[k]);
          ASSERT_EQ(angles.flipped4.v[i], scalar[1]->q[3]);
          ASSERT_EQ(angles.flipped5.v[i], scalar[1]->q[4]);
          ASSERT_EQ(angles.flipped6.v[i], scalar[1]->q[5]);
          const SingularityDistance distance = DistanceToSingularity(arm, scalar[0]->q);
          ASSERT_NEAR(branches[b].wrist.v[i], distance.wrist, 1e-12);
          // Near the stretched elbow a rounding of the pose moves the elbow's sine by its root.
          ASSERT_NEAR(branches[b].elbow.v[i], distance.elbow, 1e-7);
          ASSERT_NEAR(branches[b].shoulder.v[i], distance.shoulder, 1e-8);
        }
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
      ArmBranches baseline;
      std::array<AnglesBlock, 4> angles;
      InverseBlock(arm, flange, baseline, InstructionSet::kBaseline);
      for (int b = 0; b < 4; ++b) {
        AnglesOfBranch(arm, baseline[b], angles[b], InstructionSet::kBaseline);
        for (int k = 0; k < 6; ++k) {
          for (int i = 0; i < kLanes; ++i) ASSERT_TRUE(std::isfinite(angles[b].unflipped[k].v[i]));
        }
      }
      for (const InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512}) {
        if (!Supports(set)) continue;
        ArmBranches wide;
        InverseBlock(arm, flange, wide, set);
        ASSERT_EQ(std::memcmp(&wide, &baseline, sizeof(wide)), 0);
        for (int b = 0; b < 4; ++b) {
          AnglesBlock wide_angles;
          AnglesOfBranch(arm, wide[b], wide_angles, set);
          ASSERT_EQ(std::memcmp(&wide_angles, &angles[b], sizeof(wide_angles)), 0);
        }
      }
    }
  }
}

}  // namespace
}  // namespace millpose
