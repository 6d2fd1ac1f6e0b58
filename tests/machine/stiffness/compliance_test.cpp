// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/stiffness/compliance.hpp"

#include <Eigen/Eigenvalues>

#include "base/decompositions.hpp"
#include "tests/machine/robot/arms.hpp"
#include "tests/machine/stiffness/random_vectors.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d RandomCompliance(RandomStream& stream) {
  const Arm arm = Kr500R2830();
  const Matrix6 J = Jacobian(arm, RandomJoints(stream), Vector3d(-250, 0, 250));
  return Compliance(J, arm.stiffness).topLeftCorner<3, 3>();
}

TEST(Compliance, IsSymmetricPositiveAndInvertsTheStiffness) {
  const Arm arm = Kr500R2830();
  RandomStream stream(1, 0);
  for (int k = 0; k < 200; ++k) {
    const Matrix6 J = Jacobian(arm, RandomJoints(stream), Vector3d(-250, 0, 250));
    const Matrix6 C = Compliance(J, arm.stiffness);
    EXPECT_EQ((C - C.transpose()).norm(), 0);
    EXPECT_GT(EigenOfSymmetric3(C.topLeftCorner<3, 3>()).values[0], 0);
    const Matrix6 inverse = J.inverse();
    const Matrix6 K = inverse.transpose() * arm.stiffness.asDiagonal() * inverse;  // eq. 8
    const Matrix6 product = J.transpose() * K * C * inverse.transpose();           // free of the units' mix
    EXPECT_LT((product - Matrix6::Identity()).norm(), 1e-6) << k;
  }
}

TEST(Compliance, IsWhatJointsGiveWayUnderASmallForce) {
  const Arm arm = Kr500R2830();
  const Vector3d tip(-250, 0, 250);
  RandomStream stream(2, 0);
  for (int k = 0; k < 200; ++k) {
    const Joints q = RandomJoints(stream);
    const Matrix6 J = Jacobian(arm, q, tip);
    const Vector3d force = RandomUnit(stream);  // 1 N
    const Joints torque = J.topRows<3>().transpose() * force;
    const Joints give = torque.array() / arm.stiffness.array();
    const Vector3d moved = ForwardFlange(arm, q + give) * tip - ForwardFlange(arm, q) * tip;
    const Vector3d predicted = Compliance(J, arm.stiffness).topLeftCorner<3, 3>() * force;
    EXPECT_LT((moved - predicted).norm(), 1e-5 * predicted.norm() + 1e-11);
  }
}

TEST(Dexterity, IsOneForAnIsotropicJacobianAndZeroForASingular) {
  Matrix6 J = Matrix6::Identity();
  J.topRows<3>() *= 1000;
  EXPECT_NEAR(Dexterity(J, 1000), 1, 1e-14);
  EXPECT_LT(Dexterity(J, 1), 0.01);
  J.col(5).setZero();
  EXPECT_EQ(Dexterity(J, 1000), 0);
}

TEST(Indices, AreTheSectionOfTheEllipsoid) {
  RandomStream stream(3, 0);
  for (int k = 0; k < 1000; ++k) {
    const Matrix3d c = RandomCompliance(stream);
    const Vector3d n = RandomUnit(stream);
    const auto indices = IndicesInPlane(c, n);
    ASSERT_TRUE(indices.has_value());
    // Chen 2021 eq. 19 and 21 literally: M = (c·cᵀ)⁻¹, eigenvalues of BᵀMB.
    const Matrix3d M = (c * c.transpose()).inverse();
    const PlaneBasis basis = BasisOfPlane(n);
    Eigen::Matrix<double, 3, 2> B;
    B << basis.first, basis.second;
    const Eigen::VectorXd e = EigenOfSymmetric(B.transpose() * M * B).values;
    EXPECT_NEAR(indices->lambda_t1 * std::sqrt(e[0]), 1, 1e-6);
    EXPECT_NEAR(indices->lambda_t2 * std::sqrt(e[1]), 1, 1e-6);
    EXPECT_NEAR(indices->lambda_n * std::sqrt(n.dot(M * n)), 1, 1e-6);
    EXPECT_NEAR(indices->mu, std::sqrt(e[0] / e[1]), 1e-6);
    EXPECT_NEAR(indices->normal_compliance, n.dot(c * n), 1e-15);
    EXPECT_LE(indices->lambda_n, indices->normal_compliance * (1 + 1e-12));
  }
}

TEST(Deflections, AreWhatForcesDoInSampledDirections) {
  RandomStream stream(4, 0);
  for (int k = 0; k < 20; ++k) {
    const Matrix3d c = RandomCompliance(stream);
    const Vector3d n = RandomUnit(stream);
    const PlaneBasis basis = BasisOfPlane(n);
    const PlaneDeflections found = DeflectionsInPlane(c, n);
    double in_plane = 0, largest = 0, cross = 0;
    for (int step = 0; step < 20000; ++step) {
      const double angle = kPi * step / 20000;
      const Vector3d force = std::cos(angle) * basis.first + std::sin(angle) * basis.second;
      const Vector3d moved = c * force;
      in_plane = std::max(in_plane, (moved - n.dot(moved) * n).norm());
      largest = std::max(largest, moved.norm());
      cross = std::max(cross, std::abs(n.dot(moved)));
    }
    EXPECT_NEAR(found.in_plane / in_plane, 1, 1e-6);
    EXPECT_NEAR(found.largest / largest, 1, 1e-6);
    EXPECT_NEAR(found.cross / cross, 1, 1e-6);
    EXPECT_NEAR(found.normal, n.dot(c * n), 1e-18);
    const auto indices = IndicesInPlane(c, n);
    ASSERT_TRUE(indices.has_value());
    EXPECT_GE(found.in_plane, indices->lambda_t1 * (1 - 1e-9));  // facts about radii and displacements
    EXPECT_GE(found.normal, indices->lambda_n * (1 - 1e-9));
  }
}

TEST(Indices, OfAKnownEllipsoid) {
  const Matrix3d c = Vector3d(3e-4, 2e-4, 1e-4).asDiagonal();
  const auto z = IndicesInPlane(c, Vector3d::UnitZ());
  ASSERT_TRUE(z.has_value());
  EXPECT_NEAR(z->lambda_t1, 3e-4, 1e-18);
  EXPECT_NEAR(z->lambda_t2, 2e-4, 1e-18);
  EXPECT_NEAR(z->lambda_n, 1e-4, 1e-18);
  EXPECT_NEAR(z->mu, 2.0 / 3.0, 1e-15);
  const Matrix3d ball = 2e-4 * Matrix3d::Identity();
  EXPECT_NEAR(IndicesInPlane(ball, Vector3d(1, 2, 2) / 3)->mu, 1, 1e-15);
}

TEST(Indices, OfASingularComplianceAreEmpty) {
  EXPECT_FALSE(IndicesInPlane(Vector3d(3e-4, 2e-4, 0).asDiagonal(), Vector3d::UnitZ()).has_value());
  EXPECT_FALSE(IndicesInPlane(Matrix3d::Zero(), Vector3d::UnitZ()).has_value());
  // Rounding has eaten an axis of 1e-18 beside 1e-4, not one of 1e-10.
  EXPECT_FALSE(IndicesInPlane(Vector3d(3e-4, 2e-4, 1e-18).asDiagonal(), Vector3d::UnitZ()).has_value());
  EXPECT_TRUE(IndicesInPlane(Vector3d(3e-4, 2e-4, 1e-10).asDiagonal(), Vector3d::UnitZ()).has_value());
}

}  // namespace
}  // namespace millpose
