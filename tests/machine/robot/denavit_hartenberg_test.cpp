// SPDX-License-Identifier: GPL-3.0-or-later
// Arms from tables after Denavit and Hartenberg against the product of the table's matrices.
#include "machine/robot/denavit_hartenberg.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "base/random.hpp"
#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"

namespace millpose {
namespace {

using Rows = std::array<DhRow, 6>;

DhRow Row(double a, double alpha_deg, double d, double theta_deg = 0, int sign = 1) {
  return {a, d, DegToRad(alpha_deg), DegToRad(theta_deg), sign};
}

/// The matrix of a row as textbooks print it.
Eigen::Matrix4d Printed(const DhRow& row, double q, DhConvention convention) {
  const double t = row.sign * q + row.theta;
  const double ct = std::cos(t), st = std::sin(t), ca = std::cos(row.alpha), sa = std::sin(row.alpha);
  Eigen::Matrix4d T;
  if (convention == DhConvention::kStandard)
    T << ct, -st * ca, st * sa, row.a * ct, st, ct * ca, -ct * sa, row.a * st, 0, sa, ca, row.d, 0, 0, 0, 1;
  else
    T << ct, -st, 0, row.a, st * ca, ct * ca, -sa, -row.d * sa, st * sa, ct * sa, ca, row.d * ca, 0, 0, 0, 1;
  return T;
}

void ExpectSame(const Rows& rows, DhConvention convention) {
  const DerivedArm derived = DeriveArm(ChainOf(rows, convention), 1e-6, "own.yaml");
  RandomStream random(3, 1);
  for (int k = 0; k < 50; ++k) {
    Joints q;
    Eigen::Matrix4d product = Eigen::Matrix4d::Identity();
    for (size_t i = 0; i < 6; ++i) {
      q[static_cast<Eigen::Index>(i)] = random.Uniform(-3, 3);
      product *= Printed(rows[i], q[static_cast<Eigen::Index>(i)], convention);
    }
    const Pose arm = derived.X_SB * ForwardFlange(derived.arm, q) * derived.X_FE;
    EXPECT_LT((arm.matrix() - product).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(DenavitHartenberg, APumaInStandardForm) {
  ExpectSame({Row(350, -90, 675), Row(1150, 0, 0, -90), Row(-41, -90, 0), Row(0, 90, 1200, 0, -1),
              Row(0, -90, 0), Row(0, 180, 215)},
             DhConvention::kStandard);
}

TEST(DenavitHartenberg, AnArmInModifiedForm) {
  ExpectSame({Row(0, 0, 670), Row(312, -90, 0, -90), Row(1075, 0, 0, 0, -1), Row(225, -90, 1280, 0, -1),
              Row(0, 90, 0, 0, -1), Row(0, -90, 215, 180, -1)},
             DhConvention::kModified);
}

TEST(DenavitHartenberg, AUr10eInItsMakersForm) {
  const Rows rows{Row(0, 90, 180.7),  Row(-612.7, 0, 0),   Row(-571.55, 0, 0),
                  Row(0, 90, 174.15), Row(0, -90, 119.85), Row(0, 0, 116.55)};
  ExpectSame(rows, DhConvention::kStandard);
  EXPECT_EQ(DeriveArm(ChainOf(rows, DhConvention::kStandard), 1e-6, "own.yaml").arm.family,
            ArmFamily::kParallelAxes);
}

TEST(DenavitHartenberg, TheTwoFormsAreNotTheSame) {
  const Rows rows{Row(350, -90, 675), Row(1150, 0, 0), Row(-41, -90, 0),
                  Row(0, 90, 1200),   Row(0, -90, 0),  Row(0, 0, 215)};
  const Pose standard = ChainFrames(ChainOf(rows, DhConvention::kStandard), Joints::Zero())[7];
  const Pose modified = ChainFrames(ChainOf(rows, DhConvention::kModified), Joints::Zero())[7];
  EXPECT_GT((standard.translation() - modified.translation()).norm(), 100);
}

TEST(DenavitHartenberg, AWristWithAnOffsetIsRefusedInPlainWords) {
  Rows rows{Row(350, -90, 675), Row(1150, 0, 0, -90), Row(-41, -90, 0),
            Row(0, 90, 1200),   Row(90, -90, 0),      Row(0, 0, 215)};
  try {
    DeriveArm(ChainOf(rows, DhConvention::kStandard), 0.01, "own.yaml", "arm.dh.tolerance_mm");
    FAIL() << "not refused";
  } catch (const InputError& error) {
    const std::string text = error.what();
    for (const char* words : {"miss one point by 90 mm", "arm.dh.tolerance_mm",
                              "needs the three wrist axes to meet in one point"})
      EXPECT_NE(text.find(words), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace millpose
