// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/compensation/shift.hpp"

#include <cassert>

namespace millpose {
namespace {

/// Lowers each entry to what can be reached from its neighbour `before` it and from the one behind it.
void Lower(std::vector<double>& heights, std::span<const double> times, double speed, bool closed) {
  const size_t count = heights.size();
  const auto step = [&](size_t from, size_t to, double time) {
    heights[to] = std::min(heights[to], heights[from] + speed * time);
  };
  // Round a closed cut a bound may run on beyond where the sweep began: once more catches that.
  for (int round = 0; round < (closed ? 2 : 1); ++round) {
    for (size_t i = 1; i < count; ++i) step(i - 1, i, times[i - 1]);
    if (closed) step(count - 1, 0, times[count - 1]);
  }
  for (int round = 0; round < (closed ? 2 : 1); ++round) {
    for (size_t i = count - 1; i > 0; --i) step(i, i - 1, times[i - 1]);
    if (closed) step(0, count - 1, times[count - 1]);
  }
}

}  // namespace

double TakenOut(const Compensation::Along& deflection, std::optional<double> share) {
  if (share) return *share * deflection.expected;
  if (deflection.low <= 0 && deflection.high >= 0) return 0;
  const double side = deflection.low > 0 ? 1 : -1;
  const double least = std::min(side * deflection.low, side * deflection.high);
  const double middle = side * 0.5 * (deflection.low + deflection.high);
  return side * std::min({middle, 2 * least, side * deflection.expected});
}

void LimitChange(std::span<double> amounts, std::span<const double> times, double speed, bool closed) {
  assert(times.size() + (closed ? 0 : 1) >= amounts.size());
  if (amounts.empty()) return;
  std::vector<double> above, below;
  for (const double amount : amounts) {
    above.push_back(std::max(amount, 0.0));
    below.push_back(std::max(-amount, 0.0));
  }
  Lower(above, times, speed, closed);
  Lower(below, times, speed, closed);
  for (size_t i = 0; i < amounts.size(); ++i) amounts[i] = above[i] - below[i];
}

}  // namespace millpose
