// SPDX-License-Identifier: GPL-3.0-or-later
// Eigen's decompositions behind plain functions: each takes the compiler seconds wherever it is instantiated,
// so that happens in decompositions.cpp alone. The functions do what Eigen's classes of the same names do, to
// the bit.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace millpose {

/// Of a symmetric matrix: eigenvalues, ascending, and unit eigenvectors as columns.
struct EigenPairs {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
EigenPairs EigenOfSymmetric(const Eigen::MatrixXd& a);
struct EigenPairs3 {
  Eigen::Vector3d values;
  Eigen::Matrix3d vectors;
};
EigenPairs3 EigenOfSymmetric3(const Eigen::Matrix3d& a);

/// Singular values, descending.
Eigen::VectorXd SingularValues(const Eigen::MatrixXd& a);
/// a = U·diag(values)·Vᵀ.
struct SingularTriples3 {
  Eigen::Vector3d values;
  Eigen::Matrix3d U, V;
};
SingularTriples3 SingularOf3(const Eigen::Matrix3d& a);

/// x of a·x = b for a symmetric, by L·D·Lᵀ with pivots.
Eigen::VectorXd SolveSymmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::MatrixXd SolveSymmetricFor(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
Eigen::Vector3d SolveSymmetric3(const Eigen::Matrix3d& a, const Eigen::Vector3d& b);
/// A root S of a covariance S·Sᵀ, which may be of less than full rank, by the same.
Eigen::MatrixXd RootOfCovariance(const Eigen::MatrixXd& covariance);

/// X of a·X = b for a symmetric and positive definite, by Cholesky's L·Lᵀ.
Eigen::MatrixXd SolvePositive(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
/// That L.
Eigen::MatrixXd CholeskyOf(const Eigen::MatrixXd& a);

/// The least x of those that a·x comes nearest to b for, by a complete orthogonal decomposition: pivots below
/// `threshold` of the largest count as none (0: what rounding leaves).
Eigen::VectorXd LeastSquares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double threshold = 0);
/// x that a·x comes nearest to b for, by QR with pivots; empty where a is not of full column rank.
std::optional<Eigen::VectorXd> LeastSquaresOfFullRank(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// R of a = Q·R (Householder), of as many rows as a has columns; a has no fewer rows than columns.
Eigen::MatrixXd TriangleOf(const Eigen::MatrixXd& a);
/// R⁻¹ of an upper triangle.
Eigen::MatrixXd InverseOfTriangle(const Eigen::MatrixXd& R);
/// x of a·x = b, by LU with all pivots.
Eigen::Vector3d Solve3(const Eigen::Matrix3d& a, const Eigen::Vector3d& b);
/// By the same.
double DeterminantOf(const Eigen::MatrixXd& a);

}  // namespace millpose
