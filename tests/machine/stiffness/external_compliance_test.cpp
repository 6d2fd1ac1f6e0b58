// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/random.hpp"
#include "base/units.hpp"
#include "machine/stiffness/series.hpp"
#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace {

Eigen::Vector3d Vector(RandomStream& random) {
  return {random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1)};
}

std::vector<ExternalAxis> RandomAxes(RandomStream& random) {
  std::vector<ExternalAxis> axes(3);
  for (ExternalAxis& axis : axes) {
    axis.kind = random.Uniform() < 0.5 ? AxisKind::kLinear : AxisKind::kRotary;
    axis.carries = random.Uniform() < 0.5 ? Carries::kRobot : Carries::kWorkpiece;
    axis.direction = Vector(random).normalized();
    axis.origin = 1000 * Vector(random);
    if (random.Uniform() < 0.8) axis.compliance = axis.kind == AxisKind::kLinear ? 1e-5 : 1e-11;
  }
  return axes;
}

// An axis that yields by c per unit of load moves what it carries at the tip by c times how far the tip goes
// with the axis: (dp/dx)(dp/dx)ᵀ·c, by differences of the mechanism itself.
TEST(ExternalCompliances, AreThoseOfDifferences) {
  RandomStream random(3, 0);
  constexpr double kStep = 1e-6;
  const Arm arm = Kr500R2830();
  const Eigen::Vector3d p_FT(-250, 31, 250);
  for (int k = 0; k < 200; ++k) {
    const Mechanism mechanism(RandomAxes(random));
    ExternalPosition position;
    for (const ExternalAxis& axis : mechanism.axes())
      position.push_back(axis.kind == AxisKind::kLinear ? random.Uniform(-2000, 2000)
                                                        : random.Uniform(-3, 3));
    Pose X_WB = Pose::Identity();
    X_WB.translation() = 1000 * Vector(random);
    X_WB = mechanism.Moved(Carries::kRobot, position) * X_WB;
    Joints q;
    for (int i = 0; i < 6; ++i) q[i] = random.Uniform(-3, 3);
    const Eigen::Vector3d tip = X_WB * (ForwardFlange(arm, q) * p_FT);
    Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
    for (size_t a = 0; a < position.size(); ++a) {
      const Carries carried = mechanism.axes()[a].carries;
      ExternalPosition further = position, back = position;
      further[a] += kStep;
      back[a] -= kStep;
      const Eigen::Vector3d on_it = mechanism.Moved(carried, position).inverse() * tip;
      const Eigen::Vector3d column =
          (mechanism.Moved(carried, further) * on_it - mechanism.Moved(carried, back) * on_it) / (2 * kStep);
      expected += mechanism.axes()[a].compliance.value_or(0) * column * column.transpose();
    }
    const Matrix6 C = SeriesComplianceAt(arm, q, p_FT, ExternalCompliances(mechanism, position, X_WB));
    const Eigen::Matrix3d in_W = X_WB.linear() * C.topLeftCorner<3, 3>() * X_WB.linear().transpose();
    EXPECT_LT((in_W - expected).norm(), 1e-6 * (expected.norm() + 1e-12));
  }
}

}  // namespace
}  // namespace millpose
