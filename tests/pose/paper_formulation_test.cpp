// SPDX-License-Identifier: GPL-3.0-or-later
#include "pose/paper_formulation.hpp"

#include "tests/robot/arms.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

PaperTarget Table6Target(const Arm& arm, const Pose& X_FT) {
  const Pose X_BT = ForwardFlange(arm, Degrees(-4.512, -63.932, 103.263, 18.839, 53.130, 16.206)) * X_FT;
  return {X_BT.translation(), X_BT.linear().col(2), Degrees(-45, -140, 38, -350, -118, -350),
          Degrees(45, -30, 120, 350, 106, 350)};
}

Pose Tool() {
  Pose X_FT = Pose::Identity();
  X_FT.linear() << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  X_FT.translation() = Vector3d(-250, -28, 250);
  return X_FT;
}

TEST(PaperFormulation, SubstitutionCoversTable5AndComesBack) {
  const PaperTarget target = Table6Target(Chen2021Table6(), Tool());
  for (int k = 0; k < 6; ++k) {
    const double lower = target.lower[k], upper = target.upper[k];
    EXPECT_NEAR(FromUnbounded(-1e12, lower, upper), lower, 1e-9);
    EXPECT_NEAR(FromUnbounded(1e12, lower, upper), upper, 1e-9);
    for (double share = 0.01; share < 1; share += 0.07) {
      const double theta = lower + share * (upper - lower);
      EXPECT_NEAR(FromUnbounded(ToUnbounded(theta, lower, upper), lower, upper), theta, 1e-12);
    }
  }
  EXPECT_GT(FromUnbounded(0, DegToRad(38), DegToRad(120)), 0);  // not −79° as the printed eq. 31
}

TEST(PaperFormulation, ComesNearItsTargetAndRepeats) {
  const Arm arm = Chen2021Table6();
  const Pose X_FT = Tool();
  const PaperTarget target = Table6Target(arm, X_FT);
  PaperFormulationOptions options;
  options.generations = 500;
  const PaperResult found = PaperSearch(arm, X_FT, target, options, RandomStream(1, 0));
  EXPECT_LT(found.position_error, 5);
  EXPECT_LT(RadToDeg(found.angle_error), 1);
  EXPECT_TRUE((found.q.array() >= target.lower.array()).all() &&
              (found.q.array() <= target.upper.array()).all());
  EXPECT_EQ(PaperSearch(arm, X_FT, target, options, RandomStream(1, 0)).q, found.q);
  const Pose X_BT = ForwardFlange(arm, found.q) * X_FT;
  EXPECT_NEAR((X_BT.translation() - target.tip).norm(), found.position_error, 1e-12);
}

}  // namespace
}  // namespace millpose
