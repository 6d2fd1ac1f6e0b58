// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/stiffness/compliance.hpp"

#include <cassert>

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// adj(c) of a symmetric matrix, so that c⁻¹ = adj(c)/det(c).
Matrix3d Adjugate(const Matrix3d& c) {
  Matrix3d adjugate;
  adjugate << c.col(1).cross(c.col(2)), c.col(2).cross(c.col(0)), c.col(0).cross(c.col(1));
  return adjugate;
}

double LargerEigenvalue(const Eigen::Matrix2d& m) {
  const double half = 0.5 * (m(0, 0) - m(1, 1)), off = 0.5 * (m(0, 1) + m(1, 0));
  return 0.5 * m.trace() + std::sqrt(half * half + off * off);
}

}  // namespace

Matrix6 Compliance(const Matrix6& J, const Joints& joint_stiffness) {
  assert((joint_stiffness.array() > 0).all());
  Matrix6 C = Matrix6::Zero();
  for (int i = 0; i < 6; ++i) C.noalias() += (J.col(i) / joint_stiffness[i]) * J.col(i).transpose();
  return 0.5 * (C + C.transpose());
}

double Dexterity(const Matrix6& J, double characteristic_length) {
  Matrix6 scaled = J;
  scaled.topRows<3>() /= characteristic_length;
  const double product = scaled.squaredNorm() * scaled.inverse().squaredNorm();  // tr((JᵀJ)⁻¹) = ‖J⁻¹‖²
  return std::isfinite(product) ? 6.0 / std::sqrt(product) : 0.0;
}

PlaneBasis BasisOfPlane(const Vector3d& normal) {
  int least = 0;
  normal.cwiseAbs().minCoeff(&least);
  const Vector3d first = normal.cross(Vector3d::Unit(least)).normalized();
  return {first, normal.cross(first)};
}

std::optional<MillingPlaneIndices> IndicesInPlane(const Matrix3d& c, const Vector3d& normal) {
  const Matrix3d adjugate = Adjugate(c);
  const double det = c.col(0).dot(adjugate.col(0));
  const double scale = c.trace();
  if (!(det > kSingularCompliance * scale * scale * scale)) return std::nullopt;
  // Radius along u is 1/‖c⁻¹u‖ = det/‖adj(c)·u‖. The larger eigenvalue e of the section's 2×2 form gives the
  // smaller semi-axis; the larger follows from the product of both, det/‖c·n‖, without cancellation.
  const PlaneBasis basis = BasisOfPlane(normal);
  const Vector3d a = adjugate * basis.first, b = adjugate * basis.second;
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b);
  const double half = 0.5 * (aa - bb);
  const double e = 0.5 * (aa + bb) + std::sqrt(half * half + ab * ab);
  const Vector3d cn = c * normal;
  MillingPlaneIndices indices;
  indices.lambda_t2 = det / std::sqrt(e);
  indices.lambda_t1 = std::max(std::sqrt(e) / cn.norm(), indices.lambda_t2);
  indices.lambda_n = det / (adjugate * normal).norm();
  indices.mu = indices.lambda_t2 / indices.lambda_t1;
  indices.normal_compliance = normal.dot(cn);
  return indices;
}

PlaneDeflections DeflectionsInPlane(const Matrix3d& c, const Vector3d& normal) {
  const PlaneBasis basis = BasisOfPlane(normal);
  Eigen::Matrix<double, 3, 2> B;
  B << basis.first, basis.second;
  const Eigen::Matrix<double, 3, 2> cB = c * B;
  const Eigen::Matrix2d in_plane = B.transpose() * cB, square = cB.transpose() * cB;
  return {.normal = normal.dot(c * normal),
          .in_plane = LargerEigenvalue(in_plane),
          .largest = std::sqrt(LargerEigenvalue(square)),
          .cross = (cB.transpose() * normal).norm()};
}

}  // namespace millpose
