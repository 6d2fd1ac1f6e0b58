// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/stiffness/pose_stiffness.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "base/decompositions.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d Positive(const Vector3d& direction) {
  int largest = 0;
  direction.cwiseAbs().maxCoeff(&largest);
  return direction[largest] < 0 ? Vector3d(-direction) : direction;
}

/// Directions of the section's semi-axes: eigenvectors of BᵀMB with M = (c·cᵀ)⁻¹ up to a factor.
void SectionDirections(const Matrix3d& c, const Vector3d& normal, PoseStiffness& result) {
  const PlaneBasis basis = BasisOfPlane(normal);
  Eigen::Matrix<double, 3, 2> B;
  B << basis.first, basis.second;
  const Matrix3d inverse = c.inverse() * c.trace();  // scaled: the directions do not mind
  const Eigen::Matrix<double, 3, 2> image = inverse * B;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(image.transpose() * image);
  result.t1_direction =
      Positive(B * solver.eigenvectors().col(0));  // the least eigenvalue is the longest radius
  result.t2_direction = Positive(B * solver.eigenvectors().col(1));
}

/// C⁻¹ with lengths scaled so that its blocks compare; empty when C is singular.
std::optional<Matrix6> Invert(const Matrix6& C, double length) {
  Eigen::Matrix<double, 6, 1> scale;
  scale << Vector3d::Ones(), Vector3d::Constant(length);
  const Matrix6 scaled = scale.asDiagonal() * C * scale.asDiagonal();
  const Eigen::FullPivLU<Matrix6> lu(scaled / scaled.trace());
  if (!lu.isInvertible() || !(lu.rcond() > 1e-14)) return std::nullopt;
  const Matrix6 inverse = scale.asDiagonal() * (lu.inverse() / scaled.trace()) * scale.asDiagonal();
  return Matrix6(0.5 * (inverse + inverse.transpose()));
}

}  // namespace

PoseStiffness EvaluatePose(const Arm& arm, const Joints& q, const Vector3d& p_FT, const Vector3d& normal,
                           double characteristic_length, const std::vector<SeriesCompliance>& elements) {
  const Matrix6 J = Jacobian(arm, q, p_FT);
  PoseStiffness result;
  result.origin = ForwardFlange(arm, q) * p_FT;
  result.C = Compliance(J, arm.stiffness) + SeriesComplianceAt(arm, q, p_FT, elements);
  result.K = Invert(result.C, characteristic_length);
  const Matrix3d c = result.C.topLeftCorner<3, 3>();
  const EigenPairs3 eigen = EigenOfSymmetric3(c);
  for (int i = 0; i < 3; ++i) {
    result.lambda[i] = std::max(0.0, eigen.values[2 - i]);
    result.directions.col(i) = Positive(eigen.vectors.col(2 - i));
  }
  result.indices = IndicesInPlane(c, normal);
  result.t1_direction.setZero();
  result.t2_direction.setZero();
  if (result.indices) SectionDirections(c, normal, result);
  result.deflections = DeflectionsInPlane(c, normal);
  result.dexterity = Dexterity(J, characteristic_length);
  result.singularity = DistanceToSingularity(arm, q);
  return result;
}

}  // namespace millpose
