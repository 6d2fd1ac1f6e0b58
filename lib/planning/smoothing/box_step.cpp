// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/smoothing/box_step.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace millpose {

BoxLeastSquares::BoxLeastSquares(size_t count) : gradient_(count, 0.0) {}

/// The matrix, with the damping.
EnvelopeMatrix BoxLeastSquares::Curvatures(double damping) const {
  std::vector<size_t> first(gradient_.size());
  std::iota(first.begin(), first.end(), size_t{0});
  for (const Entry& e : entries_) first[e.row] = std::min(first[e.row], e.column);
  EnvelopeMatrix matrix(std::move(first));
  for (size_t t = 0; t < matrix.size(); ++t) matrix.At(t, t) = damping;
  for (const Entry& e : entries_) matrix.At(e.row, e.column) += e.value;
  return matrix;
}

/// Least sum over the numbers that are not held, the others where they are. False when to rounding there is
/// no single least.
bool BoxLeastSquares::SolveFree(const EnvelopeMatrix& curvatures, const std::vector<bool>& held,
                                std::vector<double>& delta) const {
  EnvelopeMatrix matrix = curvatures;
  std::vector<double> right(delta.size());
  for (size_t t = 0; t < delta.size(); ++t) right[t] = held[t] ? delta[t] : -gradient_[t];
  for (size_t r = 0; r < delta.size(); ++r) {
    for (size_t c = matrix.First(r); c <= r; ++c) {
      if (!held[r] && !held[c]) continue;
      double& value = matrix.At(r, c);
      if (r == c) {
        value = 1;
        continue;
      }
      if (!held[r]) right[r] -= value * delta[c];
      if (!held[c]) right[c] -= value * delta[r];
      value = 0;
    }
  }
  if (!matrix.Factor()) return false;
  matrix.Solve(right);
  delta = std::move(right);
  return true;
}

std::vector<double> BoxLeastSquares::Slopes(const EnvelopeMatrix& curvatures,
                                            const std::vector<double>& delta) const {
  std::vector<double> slopes = gradient_;
  curvatures.AddProduct(delta, slopes);
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
  const EnvelopeMatrix curvatures = Curvatures(damping);
  std::vector<bool> held(count);
  for (size_t t = 0; t < count; ++t) held[t] = !(lower[t] < upper[t]);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> solved = delta;
    if (!SolveFree(curvatures, held, solved)) break;
    bool done = true;
    for (size_t t = 0; t < count; ++t) {
      delta[t] = std::clamp(solved[t], lower[t], upper[t]);
      if (held[t] || delta[t] == solved[t]) continue;
      held[t] = true;
      done = false;
    }
    if (!done) continue;
    // Those that are held but would rather come back are let go.
    const std::vector<double> slopes = Slopes(curvatures, delta);
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
