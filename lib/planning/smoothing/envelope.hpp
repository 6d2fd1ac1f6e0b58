// SPDX-License-Identifier: GPL-3.0-or-later
// Symmetric matrices whose rows begin late: a band, and a ring's corner.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace millpose {

/// The lower half of a symmetric matrix, each row from its first column that is not zero by its place (the
/// row's envelope) to the diagonal. Its Cholesky factor fills the same envelope.
class EnvelopeMatrix {
 public:
  /// `first[i]` ≤ i: the first column of row i. All zero.
  explicit EnvelopeMatrix(std::vector<size_t> first);

  size_t size() const { return first_.size(); }
  size_t First(size_t row) const { return first_[row]; }
  /// From First(row) to the diagonal.
  std::span<double> Row(size_t row) { return {values_.data() + begin_[row], row - first_[row] + 1}; }
  std::span<const double> Row(size_t row) const {
    return {values_.data() + begin_[row], row - first_[row] + 1};
  }
  double& At(size_t row, size_t column) { return values_[begin_[row] + (column - first_[row])]; }

  /// Adds the product with `x` to `sum`.
  void AddProduct(std::span<const double> x, std::span<double> sum) const;

  /// Becomes its Cholesky factor; false where to rounding it has none.
  bool Factor();
  /// Of a factor: `x` becomes what times the matrix gives it.
  void Solve(std::span<double> x) const;

 private:
  std::vector<size_t> first_, begin_;
  std::vector<double> values_;
  std::vector<size_t> long_rows_;  ///< those that reach farther than a band, ascending
};

}  // namespace millpose
