// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/stiffness/series_block.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/machine/robot/arms.hpp"
#include "tests/machine/stiffness/random_vectors.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Vector3d kPoint(-250, 31, 250);

/// Any symmetric positive definite compliance at any frame of the link.
SeriesCompliance RandomElement(int link, RandomStream& stream) {
  SeriesCompliance element;
  element.link = link;
  element.X_LK =
      Eigen::Translation3d(300 * RandomNormal3(stream)) * Eigen::AngleAxisd(1.0, RandomUnit(stream));
  Matrix6 root;
  for (double& value : root.reshaped()) value = stream.Normal();
  Eigen::Matrix<double, 6, 1> scale;
  scale << Vector3d::Constant(1e-2), Vector3d::Constant(2e-5);
  element.C = scale.asDiagonal() * (root * root.transpose()) * scale.asDiagonal();
  return element;
}

struct PosesOfBlock {
  FlangeBlock flange;
  ArmBranches branches;
};

PosesOfBlock RandomPoses(const Arm& arm, RandomStream& stream) {
  PosesOfBlock block;
  for (int lane = 0; lane < kLanes; ++lane) block.flange.Set(lane, ForwardFlange(arm, RandomJoints(stream)));
  InverseBlock(arm, block.flange, block.branches);
  return block;
}

Joints AnglesOf(const Arm& arm, const ArmBranchBlock& branch, bool flipped, int lane) {
  AnglesBlock angles;
  AnglesOfBranch(arm, branch, angles);
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = angles.unflipped[static_cast<size_t>(i)].v[lane];
  if (flipped) q.tail<3>() << angles.flipped4.v[lane], angles.flipped5.v[lane], angles.flipped6.v[lane];
  return q;
}

/// Compares every reached lane of every branch with the scalar reference; returns how many there were.
int ExpectReference(const Arm& arm, const std::vector<SeriesCompliance>& elements, RandomStream& stream) {
  const PosesOfBlock block = RandomPoses(arm, stream);
  const SeriesBlock series(arm, elements, kPoint);
  int compared = 0;
  for (int branch = 0; branch < 8; ++branch) {
    const int entry = branch % EntryCount(arm);
    const ArmBranchBlock& solved = block.branches[static_cast<size_t>(entry)];
    ComplianceBlock c;
    for (Lanes* part : {&c.xx, &c.yy, &c.zz, &c.xy, &c.xz, &c.yz}) std::fill_n(part->v, kLanes, 0.5);
    series.AddTo(block.flange, solved, branch != entry, c);
    for (int l = 0; l < kLanes; ++l) {
      if (solved.reached.v[l] == 0 || solved.wrist.v[l] < 1e-3) continue;
      const Matrix6 C = SeriesComplianceAt(arm, AnglesOf(arm, solved, branch != entry, l), kPoint, elements);
      Matrix3d got;
      got << c.xx.v[l], c.xy.v[l], c.xz.v[l], c.xy.v[l], c.yy.v[l], c.yz.v[l], c.xz.v[l], c.yz.v[l],
          c.zz.v[l];
      const Matrix3d expected = C.topLeftCorner(3, 3);
      EXPECT_LT((got - Matrix3d::Constant(0.5) - expected).norm(), 1e-10 * expected.norm() + 1e-15)
          << arm.name << " branch " << branch << " lane " << l;
      ++compared;
    }
  }
  return compared;
}

TEST(SeriesBlock, GivesWhatEveryPoseGets) {
  RandomStream stream(7, 0);
  int compared = 0;
  for (const Arm& arm : AllArms()) {
    for (int link = 0; link <= 6; ++link)
      compared += ExpectReference(arm, {RandomElement(link, stream)}, stream);
    std::vector<SeriesCompliance> all;
    for (int link : {0, 0, 1, 2, 3, 4, 5, 6, 6}) all.push_back(RandomElement(link, stream));
    compared += ExpectReference(arm, all, stream);
  }
  EXPECT_GT(compared, 1000);
}

TEST(SeriesBlock, OnlyLinks4And5TurnWithTheWrist) {
  RandomStream stream(8, 0);
  for (int link = 0; link <= 6; ++link) {
    const SeriesBlock series(Kr500R2830(), {RandomElement(link, stream)}, kPoint);
    EXPECT_EQ(series.TurnsWithWrist(), link == 4 || link == 5);
    EXPECT_FALSE(series.empty());
  }
  EXPECT_TRUE(SeriesBlock(Kr500R2830(), {}, kPoint).empty());
}

TEST(SeriesBlock, SameBitsForEveryInstructionSet) {
  RandomStream stream(9, 0);
  for (const Arm& arm : {Kr500R2830(), Ur10e()}) {
    std::vector<SeriesCompliance> all;
    for (int link = 0; link <= 6; ++link) all.push_back(RandomElement(link, stream));
    const SeriesBlock series(arm, all, kPoint);
    const PosesOfBlock block = RandomPoses(arm, stream);
    const auto compute = [&](InstructionSet set) {
      ComplianceBlock c{};
      series.AddTo(block.flange, block.branches[1], true, c, set);
      return c;
    };
    const ComplianceBlock baseline = compute(InstructionSet::kBaseline);
    for (const InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512}) {
      if (!Supports(set)) continue;
      const ComplianceBlock other = compute(set);
      EXPECT_EQ(std::memcmp(&baseline, &other, sizeof(ComplianceBlock)), 0);
    }
  }
}

}  // namespace
}  // namespace millpose
