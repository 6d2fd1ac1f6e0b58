// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/stiffness/compliance_block.hpp"

#include <cstring>

#include "machine/stiffness/indices_block.hpp"
#include "tests/machine/robot/arms.hpp"
#include "tests/machine/stiffness/random_vectors.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Block {
  std::array<Joints, kLanes> q;
  FlangeBlock flange;
  ArmBranches branches;
};

Block RandomBlock(const Arm& arm, RandomStream& stream) {
  Block block;
  for (int i = 0; i < kLanes; ++i) {
    block.q[i] = RandomJoints(stream);
    block.flange.Set(i, ForwardFlange(arm, block.q[i]));
  }
  InverseBlock(arm, block.flange, block.branches);
  return block;
}

Matrix3d LaneOf(const ComplianceBlock& c, int i) {
  Matrix3d m;
  m << c.xx.v[i], c.xy.v[i], c.xz.v[i], c.xy.v[i], c.yy.v[i], c.yz.v[i], c.xz.v[i], c.yz.v[i], c.zz.v[i];
  return m;
}

TEST(ComplianceBlock, AgreesWithTheScalarReference) {
  const Vector3d p_FT(-250, 31, 250);
  RandomStream stream(1, 0);
  int compared = 0;
  for (const Arm& arm : AllArms()) {
    for (int round = 0; round < 500; ++round) {
      const Block block = RandomBlock(arm, stream);
      ComplianceBlock c;
      Lanes dexterity;
      for (int b = 0; b < EntryCount(arm); ++b) {
        LinearCompliance(arm, block.flange, block.branches[b], p_FT, c);
        DexterityOfBlock(arm, block.flange, block.branches[b], p_FT, 1000, dexterity);
        for (int i = 0; i < kLanes; ++i) {
          if (Status(arm, block.q[i]) % EntryCount(arm) != b) continue;
          const SingularityDistance distance = DistanceToSingularity(arm, block.q[i]);
          if (distance.elbow < 1e-2 || distance.wrist < 1e-3 || distance.shoulder < 10) continue;
          const Matrix6 J = Jacobian(arm, block.q[i], p_FT);
          const Matrix3d expected = Compliance(J, arm.stiffness).topLeftCorner<3, 3>();
          ASSERT_LT((LaneOf(c, i) - expected).norm(), 1e-12 * expected.norm() / distance.elbow) << arm.name;
          const double scalar = Dexterity(J, 1000);
          ASSERT_NEAR(dexterity.v[i], scalar, 1e-8 * scalar);
          ++compared;
        }
      }
    }
  }
  EXPECT_GT(compared, 10000);
}

TEST(ComplianceBlock, DexterityOfASingularPoseIsZero) {
  const Arm arm = Kr500R2830();
  Block block;
  for (int i = 0; i < kLanes; ++i) block.flange.Set(i, ForwardFlange(arm, Degrees(0, -90, 90, 0, 0, 0)));
  InverseBlock(arm, block.flange, block.branches);
  Lanes dexterity;
  DexterityOfBlock(arm, block.flange, block.branches[2], Vector3d(-250, 0, 250), 1000, dexterity);
  for (const double value : dexterity.v) EXPECT_LT(value, 1e-12);
}

TEST(ComplianceBlock, WristFlipLeavesItAsItIs) {
  const Arm arm = Kr500R2830();
  RandomStream stream(2, 0);
  for (int round = 0; round < 100; ++round) {
    const Joints q = RandomJoints(stream);
    const Joints flipped = (Joints() << q.head<3>(), q[3] + kPi, -q[4], q[5] + kPi).finished();
    const Vector3d p_FT(-250, 31, 250);
    const Matrix6 one = Compliance(Jacobian(arm, q, p_FT), arm.stiffness);
    const Matrix6 other = Compliance(Jacobian(arm, flipped, p_FT), arm.stiffness);
    EXPECT_LT((one - other).norm(), 1e-12 * one.norm());
  }
}

TEST(ComplianceBlock, DexterityOfParallelAxesIsZeroWhereTheyAreSingular) {
  const Arm arm = Ur10e();
  Block block;
  // The elbow stretched; A5 = 0.
  for (int i = 0; i < kLanes; ++i)
    block.flange.Set(
        i, ForwardFlange(arm, i % 2 ? Degrees(0, -60, 0, 10, 70, 0) : Degrees(0, -90, 90, 0, 0, 0)));
  InverseBlock(arm, block.flange, block.branches);
  int found[2] = {0, 0};
  for (const ArmBranchBlock& branch : block.branches) {
    Lanes dexterity;
    DexterityOfBlock(arm, block.flange, branch, Vector3d(-250, 0, 250), 1000, dexterity);
    for (int i = 0; i < kLanes; ++i) {
      const bool singular = branch.wrist.v[i] < 1e-9 || branch.elbow.v[i] < 1e-6;
      if (branch.reached.v[i] == 0 || !singular) continue;
      EXPECT_LT(dexterity.v[i], 1e-6);
      ++found[i % 2];
    }
  }
  EXPECT_GT(found[0], 0);
  EXPECT_GT(found[1], 0);
}

TEST(IndicesBlock, AgreeWithTheScalarReference) {
  const Arm arm = Kr500R2830();
  RandomStream stream(3, 0);
  for (int round = 0; round < 2000; ++round) {
    const Block block = RandomBlock(arm, stream);
    const Vector3d n = RandomUnit(stream);
    ComplianceBlock c;
    LinearCompliance(arm, block.flange, block.branches[2], Vector3d(-250, 31, 250), c);
    PlaneIndicesBlock indices;
    PlaneDeflectionsBlock deflections;
    IndicesInPlane(c, n, indices);
    DeflectionsInPlane(c, n, deflections);
    for (int i = 0; i < kLanes; ++i) {
      const auto expected = IndicesInPlane(LaneOf(c, i), n);
      const Matrix3d m = LaneOf(c, i);
      // The determinant cancels: its relative rounding grows with trace³/det.
      const double rounding = 1e-15 * std::pow(m.trace(), 3) / m.determinant() + 1e-13;
      if (!expected) {
        ASSERT_TRUE(std::isinf(indices.lambda_n.v[i]));
        continue;
      }
      ASSERT_NEAR(indices.lambda_t1.v[i] / expected->lambda_t1, 1, rounding);
      ASSERT_NEAR(indices.lambda_t2.v[i] / expected->lambda_t2, 1, rounding);
      ASSERT_NEAR(indices.lambda_n.v[i] / expected->lambda_n, 1, rounding);
      ASSERT_NEAR(indices.mu.v[i] / expected->mu, 1, rounding);
      ASSERT_NEAR(indices.normal_compliance.v[i] / expected->normal_compliance, 1, 1e-12);
      const PlaneDeflections moved = DeflectionsInPlane(m, n);
      ASSERT_NEAR(deflections.normal.v[i] / moved.normal, 1, 1e-12);
      ASSERT_NEAR(deflections.in_plane.v[i] / moved.in_plane, 1, 1e-12);
      ASSERT_NEAR(deflections.largest.v[i] / moved.largest, 1, 1e-12);
      ASSERT_NEAR(deflections.cross.v[i], moved.cross, 1e-12 * moved.largest);
    }
  }
}

TEST(IndicesBlock, OfASingularComplianceAreInfinite) {
  ComplianceBlock c{};
  for (int i = 0; i < kLanes; ++i) c.xx.v[i] = i == 0 ? 0 : 2e-4;
  PlaneIndicesBlock indices;
  IndicesInPlane(c, Vector3d::UnitZ(), indices);
  for (int i = 0; i < kLanes; ++i) {
    EXPECT_EQ(indices.lambda_t1.v[i], INFINITY);
    EXPECT_EQ(indices.lambda_t2.v[i], INFINITY);
    EXPECT_EQ(indices.lambda_n.v[i], INFINITY);
    EXPECT_EQ(indices.mu.v[i], 0);
  }
}

void ExpectSameForEveryInstructionSet(const Arm& arm) {
  const Vector3d p_FT(-250, 31, 250);
  RandomStream stream(4, 0);
  for (int round = 0; round < 300; ++round) {
    const Block block = RandomBlock(arm, stream);
    const Vector3d n = RandomUnit(stream);
    struct Results {
      ComplianceBlock c;
      Lanes dexterity;
      PlaneIndicesBlock indices;
      PlaneDeflectionsBlock deflections;
    };
    const auto compute = [&](InstructionSet set) {
      Results results;
      LinearCompliance(arm, block.flange, block.branches[round % EntryCount(arm)], p_FT, results.c, set);
      DexterityOfBlock(arm, block.flange, block.branches[round % EntryCount(arm)], p_FT, 1000,
                       results.dexterity, set);
      IndicesInPlane(results.c, n, results.indices, set);
      DeflectionsInPlane(results.c, n, results.deflections, set);
      return results;
    };
    const Results baseline = compute(InstructionSet::kBaseline);
    for (const InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512}) {
      if (!Supports(set)) continue;
      const Results wide = compute(set);
      ASSERT_EQ(std::memcmp(&wide, &baseline, sizeof(Results)), 0);
    }
  }
}

TEST(Blocks, AreTheSameForEveryInstructionSet) {
  ExpectSameForEveryInstructionSet(Kr500R2830());
  ExpectSameForEveryInstructionSet(Ur10e());
}

}  // namespace
}  // namespace millpose
