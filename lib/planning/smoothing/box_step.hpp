// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "planning/smoothing/envelope.hpp"

namespace millpose {

/// A least-squares problem over a row of numbers, each tied to few of its neighbours: Σ weight·(residual +
/// Σ coefficient·δ)² + Σ (slope·δ + ½·curvature·δ²), δ_t within [lower_t, upper_t], 0 among them.
class BoxLeastSquares {
 public:
  explicit BoxLeastSquares(size_t count);

  /// Up to three numbers with their coefficients; equal places may not be given twice.
  struct Term {
    size_t at;
    double coefficient;
  };
  template <size_t kTerms>
  void Add(double weight, double residual, const std::array<Term, kTerms>& terms) {
    for (size_t i = 0; i < kTerms; ++i) {
      gradient_[terms[i].at] += 2 * weight * residual * terms[i].coefficient;
      for (size_t k = 0; k <= i; ++k) {
        AddEntry(terms[i].at, terms[k].at, 2 * weight * terms[i].coefficient * terms[k].coefficient);
      }
    }
  }
  /// `curvature` ≥ 0.
  void AddCurve(size_t at, double slope, double curvature) {
    gradient_[at] += slope;
    AddEntry(at, at, curvature);
  }

  /// The δ within its bounds of the least sum, with `damping` (of the largest curvature, > 0)·½δ² added for
  /// every number: Cholesky within the envelope and an active set, which takes in and lets go many at once
  /// and is ended after a few rounds, so that the answer may be a little off the least but never out of
  /// bounds.
  std::vector<double> Solve(const std::vector<double>& lower, const std::vector<double>& upper,
                            double damping) const;

 private:
  struct Entry {
    size_t row, column;
    double value;
  };
  void AddEntry(size_t a, size_t b, double value) {
    entries_.push_back(a > b ? Entry{a, b, value} : Entry{b, a, value});
  }
  EnvelopeMatrix Curvatures(double damping) const;
  bool SolveFree(const EnvelopeMatrix& curvatures, const std::vector<bool>& held,
                 std::vector<double>& delta) const;
  std::vector<double> Slopes(const EnvelopeMatrix& curvatures, const std::vector<double>& delta) const;

  std::vector<double> gradient_;
  std::vector<Entry> entries_;
};

}  // namespace millpose
