// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/box_step.hpp"

#include <Eigen/SparseCholesky>
#include <cassert>

namespace millpose {

BoxLeastSquares::BoxLeastSquares(size_t count) : gradient_(count, 0.0) {}

std::vector<double> BoxLeastSquares::Solve(const std::vector<double>& lower,
                                           const std::vector<double>& upper) const {
  constexpr int kRounds = 8;         // after these, what still leaves its bounds is cut off there
  constexpr double kLeast = 1e-12;   // relative to the largest diagonal entry: keeps the matrix definite
  const size_t count = gradient_.size();
  assert(lower.size() == count && upper.size() == count);
  double largest = 0;
  std::vector<double> diagonal(count, 0.0);
  for (const Entry& e : entries_) {
    if (e.row == e.column) diagonal[e.row] += e.value;
  }
  for (const double value : diagonal) largest = std::max(largest, value);
  if (largest == 0) return std::vector<double>(count, 0.0);

  std::vector<double> delta(count, 0.0);
  std::vector<bool> held(count);
  for (size_t t = 0; t < count; ++t) held[t] = !(lower[t] < upper[t]);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Eigen::Triplet<double>> triplets;
    Eigen::VectorXd right(count);
    for (size_t t = 0; t < count; ++t) {
      right[static_cast<Eigen::Index>(t)] = held[t] ? delta[t] : -gradient_[t];
      triplets.emplace_back(t, t, held[t] ? 1.0 : kLeast * largest);
    }
    for (const Entry& e : entries_) {
      if (!held[e.row] && !held[e.column]) {
        triplets.emplace_back(e.row, e.column, e.value);
      } else if (e.row != e.column && held[e.row] != held[e.column]) {
        const size_t free = held[e.row] ? e.column : e.row, fixed = held[e.row] ? e.row : e.column;
        right[static_cast<Eigen::Index>(free)] -= e.value * delta[fixed];
      }
    }
    const auto size = static_cast<Eigen::Index>(count);
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> solver(
        matrix);
    if (solver.info() != Eigen::Success) break;  // to rounding not definite: stay where it was definite
    const Eigen::VectorXd solved = solver.solve(right);
    bool inside = true;
    for (size_t t = 0; t < count; ++t) {
      if (held[t]) continue;
      const double value = solved[static_cast<Eigen::Index>(t)];
      delta[t] = std::clamp(value, lower[t], upper[t]);
      if (delta[t] != value) inside = false, held[t] = true;
    }
    if (inside) break;
  }
  return delta;
}

}  // namespace millpose
