// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/box_step.hpp"

#include <Eigen/SparseCholesky>
#include <cassert>

namespace millpose {

BoxLeastSquares::BoxLeastSquares(size_t count) : gradient_(count, 0.0) {}

/// Least sum over the numbers that are not held, the others where they are. False when to rounding there is
/// no single least.
bool BoxLeastSquares::SolveFree(const std::vector<bool>& held, double damping,
                                std::vector<double>& delta) const {
  const auto size = static_cast<Eigen::Index>(delta.size());
  std::vector<Eigen::Triplet<double>> triplets;
  Eigen::VectorXd right(size);
  for (Eigen::Index t = 0; t < size; ++t) {
    const bool fixed = held[static_cast<size_t>(t)];
    right[t] = fixed ? delta[static_cast<size_t>(t)] : -gradient_[static_cast<size_t>(t)];
    triplets.emplace_back(t, t, fixed ? 1.0 : damping);
  }
  for (const Entry& e : entries_) {
    const auto row = static_cast<Eigen::Index>(e.row), column = static_cast<Eigen::Index>(e.column);
    if (!held[e.row] && !held[e.column]) {
      triplets.emplace_back(row, column, e.value);
    } else if (!held[e.row]) {
      right[row] -= e.value * delta[e.column];
    } else if (!held[e.column]) {
      right[column] -= e.value * delta[e.row];
    }
  }
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  // In the natural order the matrix is a band, and its factor too.
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> solver(
      matrix);
  if (solver.info() != Eigen::Success) return false;
  const Eigen::VectorXd solved = solver.solve(right);
  std::copy(solved.begin(), solved.end(), delta.begin());
  return true;
}

std::vector<double> BoxLeastSquares::Slopes(const std::vector<double>& delta, double damping) const {
  std::vector<double> slopes = gradient_;
  for (size_t t = 0; t < delta.size(); ++t) slopes[t] += damping * delta[t];
  for (const Entry& e : entries_) {
    slopes[e.row] += e.value * delta[e.column];
    if (e.row != e.column) slopes[e.column] += e.value * delta[e.row];
  }
  return slopes;
}

std::vector<double> BoxLeastSquares::Solve(const std::vector<double>& lower, const std::vector<double>& upper,
                                           double damping) const {
  constexpr int kRounds = 12;  // of the active set; then what leaves its bounds is cut off there
  const size_t count = gradient_.size();
  assert(lower.size() == count && upper.size() == count);
  std::vector<double> diagonal(count, 0.0), delta(count, 0.0);
  for (const Entry& e : entries_) {
    if (e.row == e.column) diagonal[e.row] += e.value;
  }
  const double largest = *std::max_element(diagonal.begin(), diagonal.end());
  if (largest == 0) return delta;
  damping *= largest;
  std::vector<bool> held(count);
  for (size_t t = 0; t < count; ++t) held[t] = !(lower[t] < upper[t]);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> solved = delta;
    if (!SolveFree(held, damping, solved)) break;
    bool done = true;
    for (size_t t = 0; t < count; ++t) {
      delta[t] = std::clamp(solved[t], lower[t], upper[t]);
      if (held[t] || delta[t] == solved[t]) continue;
      held[t] = true;
      done = false;
    }
    if (!done) continue;
    // Those that are held but would rather come back are let go.
    const std::vector<double> slopes = Slopes(delta, damping);
    for (size_t t = 0; t < count; ++t) {
      if (!held[t] || !(lower[t] < upper[t])) continue;
      if (delta[t] == upper[t] ? slopes[t] <= 0 : slopes[t] >= 0) continue;
      held[t] = false;
      done = false;
    }
    if (done) break;
  }
  return delta;
}

}  // namespace millpose
