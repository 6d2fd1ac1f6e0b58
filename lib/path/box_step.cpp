// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/box_step.hpp"

#include <algorithm>
#include <cassert>

namespace millpose {

BoxLeastSquares::BoxLeastSquares(size_t count) : gradient_(count, 0.0) {}

/// The lower half of the matrix, with the damping.
BoxLeastSquares::Matrix BoxLeastSquares::Curvatures(double damping) const {
  const auto size = static_cast<Eigen::Index>(gradient_.size());
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(gradient_.size() + entries_.size());
  for (Eigen::Index t = 0; t < size; ++t) triplets.emplace_back(t, t, damping);
  for (const Entry& e : entries_)
    triplets.emplace_back(static_cast<Eigen::Index>(e.row), static_cast<Eigen::Index>(e.column), e.value);
  Matrix matrix(size, size);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

/// Least sum over the numbers that are not held, the others where they are. False when to rounding there is
/// no single least. `factor` has been shown the matrix's pattern.
bool BoxLeastSquares::SolveFree(const Matrix& curvatures, const std::vector<bool>& held, Factor& factor,
                                std::vector<double>& delta) const {
  Matrix matrix = curvatures;
  Eigen::VectorXd right(matrix.rows());
  for (Eigen::Index t = 0; t < matrix.rows(); ++t) {
    const auto i = static_cast<size_t>(t);
    right[t] = held[i] ? delta[i] : -gradient_[i];
  }
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
    const auto c = static_cast<size_t>(column);
    for (Matrix::InnerIterator entry(matrix, column); entry; ++entry) {
      const auto r = static_cast<size_t>(entry.row());
      if (!held[r] && !held[c]) continue;
      if (r == c) {
        entry.valueRef() = 1;
        continue;
      }
      if (!held[r]) right[entry.row()] -= entry.value() * delta[c];
      if (!held[c]) right[column] -= entry.value() * delta[r];
      entry.valueRef() = 0;
    }
  }
  factor.factorize(matrix);
  if (factor.info() != Eigen::Success) return false;
  const Eigen::VectorXd solved = factor.solve(right);
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
  const Matrix curvatures = Curvatures(damping);
  Factor factor;
  factor.analyzePattern(curvatures);
  std::vector<bool> held(count);
  for (size_t t = 0; t < count; ++t) held[t] = !(lower[t] < upper[t]);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> solved = delta;
    if (!SolveFree(curvatures, held, factor, solved)) break;
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
