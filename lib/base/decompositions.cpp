// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/decompositions.hpp"

#include <Eigen/Dense>

namespace millpose {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

EigenPairs EigenOfSymmetric(const MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

EigenPairs3 EigenOfSymmetric3(const Matrix3d& a) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

VectorXd SingularValues(const MatrixXd& a) { return Eigen::JacobiSVD<MatrixXd>(a).singularValues(); }

SingularTriples3 SingularOf3(const Matrix3d& a) {
  const Eigen::JacobiSVD<Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixU(), svd.matrixV()};
}

VectorXd SolveSymmetric(const MatrixXd& a, const VectorXd& b) { return a.ldlt().solve(b); }

MatrixXd SolveSymmetricFor(const MatrixXd& a, const MatrixXd& b) { return a.ldlt().solve(b); }

Vector3d SolveSymmetric3(const Matrix3d& a, const Vector3d& b) { return a.ldlt().solve(b); }

MatrixXd RootOfCovariance(const MatrixXd& covariance) {
  const Eigen::LDLT<MatrixXd> factor(covariance);
  const MatrixXd lower = factor.matrixL();
  return factor.transpositionsP().transpose() *
         MatrixXd(lower * factor.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal());
}

MatrixXd SolvePositive(const MatrixXd& a, const MatrixXd& b) { return a.llt().solve(b); }

MatrixXd CholeskyOf(const MatrixXd& a) { return a.llt().matrixL(); }

VectorXd LeastSquares(const MatrixXd& a, const VectorXd& b, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> fit;
  if (threshold > 0) fit.setThreshold(threshold);
  return fit.compute(a).solve(b);
}

std::optional<VectorXd> LeastSquaresOfFullRank(const MatrixXd& a, const VectorXd& b) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(a);
  if (qr.rank() < a.cols()) return std::nullopt;
  return qr.solve(b);
}

MatrixXd TriangleOf(const MatrixXd& a) {
  return Eigen::HouseholderQR<MatrixXd>(a).matrixQR().topRows(a.cols()).triangularView<Eigen::Upper>();
}

MatrixXd InverseOfTriangle(const MatrixXd& R) {
  return R.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(R.rows(), R.cols()));
}

Vector3d Solve3(const Matrix3d& a, const Vector3d& b) { return a.fullPivLu().solve(b); }

double DeterminantOf(const MatrixXd& a) { return a.fullPivLu().determinant(); }

}  // namespace millpose
