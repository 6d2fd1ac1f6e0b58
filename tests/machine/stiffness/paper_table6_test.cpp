// SPDX-License-Identifier: GPL-3.0-or-later
// Table 6 of Chen 2021 on the arm and tool that explain it (docs/stiffness.md).
#include "machine/stiffness/compliance.hpp"
#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

const std::array<Joints, 5> kTable6{
    Degrees(-4.512, -63.932, 103.263, 18.839, 53.130, 16.206),
    Degrees(-8.468, -61.606, 103.741, 35.867, 57.796, 30.678),
    Degrees(-11.750, -57.984, 104.228, 49.943, 65.186, 42.549),
    Degrees(-14.154, -53.296, 104.597, 61.066, 74.504, 51.833),
    Degrees(-15.536, -47.718, 104.628, 69.806, 85.137, 59.040),
};
const Vector3d kToolAxis = Vector3d(0.999833, -0.018257, 0.000586).normalized();
const Vector3d kTip = Vector3d(-0.66, -28.26, 250.33) - 250 * kToolAxis;

TEST(PaperTable6, PosesShareTheToolAxis) {
  Vector3d mean = Vector3d::Zero();
  for (const Joints& q : kTable6) mean += ForwardFlange(Chen2021Table6(), q).linear() * kToolAxis;
  mean.normalize();
  for (const Joints& q : kTable6) {
    const Vector3d axis = ForwardFlange(Chen2021Table6(), q).linear() * kToolAxis;
    EXPECT_LT(RadToDeg(std::asin(axis.cross(mean).norm())), 0.03);
  }
  EXPECT_LT(mean.x(), -0.99);  // a vertical wall in front of the arm
}

TEST(PaperTable6, PosesShareTheTip) {
  Vector3d mean = Vector3d::Zero();
  for (const Joints& q : kTable6) mean += ForwardFlange(Chen2021Table6(), q) * kTip / 5;
  double square = 0;
  for (const Joints& q : kTable6)
    square += (ForwardFlange(Chen2021Table6(), q) * kTip - mean).squaredNorm() / 5;
  EXPECT_LT(std::sqrt(square), 1.1);
  const Vector3d first = ForwardFlange(Chen2021Table6(), kTable6[0]) * kTip;
  EXPECT_LT((first - Vector3d(2076.7, -18.6, 1006.1)).norm(), 0.1);
}

TEST(PaperTable6, WithKukasOwnA6TheAxesPart) {
  double apart = 0;
  const Vector3d first = ForwardFlange(Kr500R2830(), kTable6[0]).linear() * kToolAxis;
  for (const Joints& q : kTable6)
    apart = std::max(apart, std::acos(first.dot(ForwardFlange(Kr500R2830(), q).linear() * kToolAxis)));
  EXPECT_GT(RadToDeg(apart), 5);
}

TEST(PaperTable6, IndicesRiseFromPose1ToPose5) {
  const double expected[5][5] = {{5.6968, 3.0761, 2.0905, 3.0291, 2.5833},
                                 {5.8317, 3.1817, 2.0681, 2.8546, 2.6249},
                                 {5.9511, 3.3847, 2.0656, 2.6802, 2.7252},
                                 {5.9346, 3.6820, 2.0703, 2.5383, 2.8762},
                                 {5.7918, 4.0368, 2.0396, 2.3891, 3.0382}};
  const Arm arm = Chen2021Table6();
  for (int k = 0; k < 5; ++k) {
    const Matrix6 C = Compliance(Jacobian(arm, kTable6[k], kTip), arm.stiffness);
    const Vector3d normal = ForwardFlange(arm, kTable6[k]).linear() * kToolAxis;
    const auto at = IndicesInPlane(C.topLeftCorner<3, 3>(), normal);
    ASSERT_TRUE(at.has_value());
    const double f = 0.5 * at->lambda_t2 + 0.5 * at->lambda_n;  // eq. 23
    const double found[5] = {at->lambda_t1, at->lambda_t2, at->lambda_n, at->normal_compliance, f};
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(found[i] * 1e4, expected[k][i], 1e-3) << k << " " << i;
  }
}

}  // namespace
}  // namespace millpose
