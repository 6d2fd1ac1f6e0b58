// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/smoothing/envelope.hpp"

#include <algorithm>
#include <cmath>

namespace millpose {
namespace {

constexpr size_t kBand = 2;  // columns before the diagonal that every row may have

}  // namespace

EnvelopeMatrix::EnvelopeMatrix(std::vector<size_t> first) : first_(std::move(first)) {
  size_t size = 0;
  for (size_t row = 0; row < first_.size(); ++row) {
    begin_.push_back(size);
    size += row - first_[row] + 1;
    if (row - first_[row] > kBand) long_rows_.push_back(row);
  }
  values_.assign(size, 0.0);
}

void EnvelopeMatrix::AddProduct(std::span<const double> x, std::span<double> sum) const {
  for (size_t i = 0; i < size(); ++i) {
    const double* row = Row(i).data();
    const size_t first = first_[i];
    double own = sum[i];
    for (size_t k = first; k < i; ++k) {
      own += row[k - first] * x[k];
      sum[k] += row[k - first] * x[i];
    }
    sum[i] = own + row[i - first] * x[i];
  }
}

bool EnvelopeMatrix::Factor() {
  for (size_t i = 0; i < size(); ++i) {
    double* row = Row(i).data();
    const size_t first = first_[i];
    double diagonal = row[i - first];
    for (size_t k = first; k < i; ++k) {
      const double* other = Row(k).data();
      const size_t from = first_[k];
      double value = row[k - first];
      for (size_t j = std::max(first, from); j < k; ++j) value -= other[j - from] * row[j - first];
      row[k - first] = value / other[k - from];
      diagonal -= row[k - first] * row[k - first];
    }
    if (!(diagonal > 0)) return false;
    row[i - first] = std::sqrt(diagonal);
  }
  return true;
}

void EnvelopeMatrix::Solve(std::span<double> x) const {
  for (size_t i = 0; i < size(); ++i) {
    const double* row = Row(i).data();
    const size_t first = first_[i];
    double value = x[i];
    for (size_t k = first; k < i; ++k) value -= x[k] * row[k - first];
    x[i] = value / row[i - first];
  }
  for (size_t i = size(); i-- > 0;) {
    double value = x[i];
    const auto take = [&](size_t row) {
      if (first_[row] <= i) value -= Row(row)[i - first_[row]] * x[row];
    };
    const size_t near = std::min(size(), i + kBand + 1);
    for (size_t row = i + 1; row < near; ++row) take(row);
    for (auto row = std::ranges::lower_bound(long_rows_, near); row != long_rows_.end(); ++row) take(*row);
    x[i] = value / Row(i).back();
  }
}

}  // namespace millpose
