// SPDX-License-Identifier: GPL-3.0-or-later
// Straight motions on a part while rail and table move.
#include "machine/motion/coordinated_motion.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "machine/motion/line.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/machine/collision/sample_cell.hpp"

namespace millpose::test {
namespace {

using Eigen::Vector3d;

Carrier CoordinatedCarrier(const ExternalPosition& from, const ExternalPosition& to) {
  const Cell cell = EmptyCell();
  ExternalAxis rail{.name = "rail", .direction = Vector3d::UnitY(), .compliance = {}};
  ExternalAxis table{.name = "table",
                     .kind = AxisKind::kRotary,
                     .carries = Carries::kWorkpiece,
                     .direction = Vector3d::UnitZ(),
                     .origin = Vector3d(2500, 0, 0),
                     .compliance = {}};
  CoordinatedMotion ride{Mechanism({rail, table}), cell.X_WB, Pose(Eigen::Translation3d(2500, 100, 700)),
                         from, to};
  return {cell.arm, cell.X_WB, cell.X_FT, std::make_shared<const CoordinatedMotion>(ride)};
}

const Joints kStart = Degrees(-4.5, -63.9, 103.3, 18.8, 53.1, 16.2);

TEST(CoordinatedMotion, MovesTheBaseAsSeenFromThePart) {
  const Carrier carrier = CoordinatedCarrier({100, 0}, {300, 0.2});
  EXPECT_EQ(carrier.ride->At(0.25), ExternalPosition({150, 0.05}));
  // By hand: the table turns the part by 0.1 about its axis, seen from which the base turns back.
  const Eigen::AngleAxisd back(-0.1, Vector3d::UnitZ());
  const Vector3d base = carrier.ride->X_WB.translation() + Vector3d(0, 200, 0) - Vector3d(2500, 0, 0);
  const Vector3d wanted = back * base + Vector3d(0, -100, -700);
  EXPECT_LT((carrier.BasePose(0.5).translation() - wanted).norm(), 1e-9);
}

TEST(CoordinatedMotion, AStraightMotionIsStraightOnThePart) {
  const Carrier carrier = CoordinatedCarrier({0, 0}, {80, 0.05});
  Pose end = carrier.ToolPose(kStart);
  end.translation() += Vector3d(10, 30, -5);
  const Joints any = Joints::Constant(100);
  const LineMotion motion = FollowLine(carrier, kStart, end, -any, any, {1, 0.01, 0.2});
  ASSERT_EQ(motion.problem, "");
  const PoseLine line(carrier.ToolPose(kStart), end);
  const double count = static_cast<double>(motion.joints.size()) - 1;
  for (size_t i = 0; i < motion.joints.size(); ++i) {
    const double share = static_cast<double>(i) / count;
    const Pose tool = carrier.ToolPose(motion.joints[i], share);
    EXPECT_LT((tool.translation() - line.At(share).translation()).norm(), 1e-6) << share;
    EXPECT_LT(AngleBetween(tool.linear(), line.At(share).linear()), 1e-8) << share;
  }
  const auto middle = OnLine(carrier, kStart, motion.joints.back(), 0.5);
  ASSERT_TRUE(middle);
  EXPECT_LT((carrier.ToolPose(*middle, 0.5).translation() - line.At(0.5).translation()).norm(), 1e-6);
  // Joints that turn evenly are off by what is said, half-way.
  const Joints even = (kStart + motion.joints.back()) / 2;
  EXPECT_NEAR(HalfwayDeviation(carrier, kStart, motion.joints.back()).position,
              (carrier.ToolPose(even, 0.5).translation() - line.At(0.5).translation()).norm(), 1e-9);
  const auto most = JointDeviation(carrier, kStart, motion.joints.back());
  ASSERT_TRUE(most);
  for (int j = 0; j < 6; ++j) EXPECT_GE((*most)[j] + 1e-12, std::abs((*middle - even)[j]));
}

// The arm held still on a moving rail: the tip runs along the part backwards.
TEST(CoordinatedMotion, WhereNothingMovesTheRideCountsForNothing) {
  const Carrier riding = CoordinatedCarrier({50, 0.1}, {50, 0.1});
  Carrier standing = riding;
  standing.ride = nullptr;
  standing.X_WB = riding.BasePose(0);
  Joints to = kStart;
  to[1] += 0.02;
  EXPECT_EQ(*OnLine(riding, kStart, to, 0.3), *OnLine(standing, kStart, to, 0.3));
}

}  // namespace
}  // namespace millpose::test
