// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace millpose {

/// A stretch of surface that spans lower..upper of the position (of planes or radii) and wants at least
/// `density` passes per mm of it.
struct Stretch {
  double lower = 0, upper = 0, density = 1;
};

/// Counts passes along a position: the integral of the largest density at each place. Where there is no
/// surface, positions pass for free.
class PassScale {
 public:
  PassScale(const std::vector<Stretch>& stretches, double lower, double upper);
  /// Passes that the whole range wants, rounded up, at least 1; the budget is checked before (see
  /// budget.hpp).
  int count() const;
  /// Passes from the lower end to a position, of count().
  double PassesAt(double position) const;
  double PositionAt(double passes) const;
  /// Passes that the range wants, as a number that may exceed any integer.
  double wanted() const { return total(); }
  /// One position per pass, the first and last half a pass inside.
  std::vector<double> Positions() const;

 private:
  double total() const { return ways_.back().second; }
  std::vector<std::pair<double, double>> ways_;  // position, passes up to it; ascending
};

/// Positions spread evenly over lower..upper, their number the least that keeps their distance at or below
/// `stepover`; the first and last lie half a distance inside.
std::vector<double> SpreadEvenly(double lower, double upper, double stepover);

}  // namespace millpose
