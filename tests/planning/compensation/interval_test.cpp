// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/compensation/interval.hpp"

#include <gtest/gtest.h>

#include <random>

#include "base/rotation.hpp"
#include "tests/program/sample_plan.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// A pose, and a spring beside the joints.
struct Case {
  Arm arm = SampleArm();
  Joints q = SamplePlan().passes[0].points[2].q;
  Vector3d tip = SampleTool().translation();
  std::vector<SeriesCompliance> beside;

  explicit Case(bool spring) {
    arm.stiffness << 8.9e9, 6.78e9, 1.13e10, 2.01e9, 1.65e9, 1.35e9;  // Chen 2021, eq. 14
    if (!spring) return;
    SeriesCompliance element;
    element.link = 6;
    element.C.diagonal() << 4e-5, 6e-5, 1e-5, 1e-9, 2e-9, 1e-9;
    beside.push_back(element);
  }
};

Vector3d Unit(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Vector3d(normal(random), normal(random), normal(random)).normalized();
}

/// What an arm whose joints give way by `softer` times as much does, by the stiffness module.
double Moved(const Case& c, const Joints& softer, double beside, const Vector3d& direction,
             const Vector3d& force) {
  const Matrix6 joints =
      Compliance(Jacobian(c.arm, c.q, c.tip), Joints(c.arm.stiffness.cwiseQuotient(softer)));
  const Matrix6 more = beside * SeriesComplianceAt(c.arm, c.q, c.tip, c.beside);
  return direction.dot((joints + more).topLeftCorner<3, 3>() * force);
}

TEST(Interval, HoldsEveryArmAndForceWithinTheBoundsAndIsNoWider) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(0, 1);
  for (const bool spring : {false, true}) {
    const Case c(spring);
    const ComplianceParts parts(c.arm, c.q, c.tip, c.beside);
    for (int k = 0; k < 12; ++k) {
      const Vector3d direction = Unit(random), force = 500 * Unit(random);
      const ForceBounds forces{0.1 + 0.3 * any(random), DegToRad(30) * any(random)};
      StiffnessBounds stiffness;
      for (double& share : stiffness.joints) share = 0.2 * any(random);
      stiffness.beside = 0.15;
      const Compensation::Along found = parts.Along(direction, force, forces, stiffness);
      EXPECT_NEAR(found.expected, Moved(c, Joints::Ones(), 1, direction, force), 1e-15);
      double least = found.high, most = found.low;
      // Every corner of the stiffness's bounds, with forces on the rim of the cone and in it.
      for (unsigned corner = 0; corner < 128; ++corner) {
        Joints softer;
        for (int j = 0; j < 6; ++j)
          softer[j] =
              1 / (1 + ((corner >> j) & 1U ? -1 : 1) * stiffness.joints[j] * (corner % 3 ? 1 : any(random)));
        const double beside = 1 / (1 + (corner >> 6 ? -1 : 1) * stiffness.beside);
        for (int turn = 0; turn < 36; ++turn)
          for (const double off : {0.0, 0.5, 1.0})
            for (const double length : {-1.0, 1.0}) {
              const Vector3d side =
                  RotationAbout(force.normalized(), DegToRad(10 * turn)) * force.unitOrthogonal();
              const Vector3d F = (1 + length * forces.length) *
                                 (RotationAbout(force.normalized().cross(side), off * forces.angle) * force);
              const double moved = Moved(c, softer, beside, direction, F);
              least = std::min(least, moved);
              most = std::max(most, moved);
            }
      }
      const double width = found.high - found.low;
      EXPECT_GE(least, found.low - 1e-12);
      EXPECT_LE(most, found.high + 1e-12);
      EXPECT_LT(least - found.low, 0.05 * width);  // the rim is looked at every 10 degrees
      EXPECT_LT(found.high - most, 0.05 * width);
    }
  }
}

TEST(Interval, IsAPointWhereEverythingIsSure) {
  const Case c(true);
  const ComplianceParts parts(c.arm, c.q, c.tip, c.beside);
  const Compensation::Along found = parts.Along(Vector3d::UnitZ(), {3, 4, 5}, {0, 0}, {Joints::Zero(), 0});
  EXPECT_NEAR(found.low, found.expected, 1e-15);
  EXPECT_NEAR(found.high, found.expected, 1e-15);
}

TEST(Interval, AForceMayVanishButNotTurnRound) {
  const Case c(false);
  const ComplianceParts parts(c.arm, c.q, c.tip, c.beside);
  const Vector3d direction = (parts.sum() * Vector3d(1, 2, 3)).normalized();
  const Compensation::Along found = parts.Along(direction, {1, 2, 3}, {5, 0}, {Joints::Zero(), 0});
  EXPECT_NEAR(found.low, 0, 1e-15);
  EXPECT_NEAR(found.high, 6 * found.expected, 1e-12);
}

}  // namespace
}  // namespace millpose
