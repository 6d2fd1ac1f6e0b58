// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/freedom.hpp"

#include "base/error.hpp"
#include "pose/evaluator.hpp"
#include "tests/pose/problems.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

MillingPoint PointWithAxis(const Vector3d& axis) {
  MillingPoint point;
  point.position = Vector3d(1, 2, 3);
  point.normal = point.tool_axis = axis.normalized();
  point.feed = axis.unitOrthogonal();
  return point;
}

void ExpectRigid(const Pose& X) {
  EXPECT_LT((X.linear() * X.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_GT(X.linear().determinant(), 0);
}

TEST(NominalToolPose, PutsXAlongTheReference) {
  const Pose X = NominalToolPose(PointWithAxis(Vector3d(-1, 0.2, 0.3)), Vector3d::UnitZ());
  ExpectRigid(X);
  EXPECT_EQ(X.translation(), Vector3d(1, 2, 3));
  EXPECT_NEAR(X.linear().col(2).dot(Vector3d(-1, 0.2, 0.3).normalized()), 1, 1e-15);
  EXPECT_NEAR(X.linear().col(1).z(), 0, 1e-15);  // the reference lies in the x-z plane
  EXPECT_GT(X.linear().col(0).z(), 0);
}

TEST(NominalToolPose, FallsBackToTheLeastAlignedAxis) {
  const double tilt = std::tan(DegToRad(0.9));
  const Pose X = NominalToolPose(PointWithAxis(Vector3d(0, tilt, 1)), Vector3d::UnitZ());
  ExpectRigid(X);
  EXPECT_NEAR(X.linear()(0, 0), 1, 1e-15);  // world x, not z
  const double more = std::tan(DegToRad(1.1));
  EXPECT_NEAR(NominalToolPose(PointWithAxis(Vector3d(0, more, 1)), Vector3d::UnitZ()).linear()(0, 0), 0,
              1e-15);
}

TEST(Freedom, RotationTurnsAboutTheToolAxis) {
  const auto rotation = MakeFreedom("rotation");
  EXPECT_TRUE(rotation->Periodic());
  const Pose X = NominalToolPose(PointWithAxis(Vector3d(-1, 0.2, 0.3)), Vector3d::UnitZ());
  for (const double angle : {-3.0, -0.4, 0.0, 1.0, 3.1}) {
    const Pose expected = X * Eigen::AngleAxisd(angle, Vector3d::UnitZ());
    EXPECT_LT((rotation->Apply(X, angle).matrix() - expected.matrix()).norm(), 1e-14);
  }
  const Pose lower = rotation->Apply(X, rotation->Lower()), upper = rotation->Apply(X, rotation->Upper());
  EXPECT_LT((lower.matrix() - upper.matrix()).norm(), 1e-14);
}

TEST(Freedom, UnknownNameIsAnErrorWithTheNearest) {
  try {
    MakeFreedom("rotatoin");
    FAIL();
  } catch (const InputError& error) {
    const std::string told = error.what();
    EXPECT_TRUE(told.starts_with("no freedom \"rotatoin\"; known: rotation, lead, tilt")) << told;
    EXPECT_TRUE(told.ends_with("; did you mean \"rotation\"?")) << told;
  }
}

TEST(Freedom, ValuesAreBroughtIntoTheRangeAndComparedTheShortWay) {
  const auto rotation = MakeFreedom("rotation");
  for (double value = -20; value < 20; value += 0.37) {
    const double inside = Confine(*rotation, value);
    EXPECT_GE(inside, -kPi - 1e-12);
    EXPECT_LE(inside, kPi + 1e-12);
    EXPECT_NEAR(std::remainder(inside - value, 2 * kPi), 0, 1e-12);
    const double apart = Difference(*rotation, 0.3, value);
    EXPECT_LE(std::abs(apart), kPi + 1e-12);
    EXPECT_NEAR(std::remainder(0.3 + apart - value, 2 * kPi), 0, 1e-12);
  }
}

}  // namespace
}  // namespace millpose
