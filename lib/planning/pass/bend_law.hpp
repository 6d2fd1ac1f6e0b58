// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/pass/pass_checks.hpp"

namespace millpose {

/// How far a motion between neighbouring points may bend (HalfwayDeviation): up to a bound or, where the
/// points lie too far apart for that, a little more than with the freedoms unchanged.
class BendLaw {
 public:
  BendLaw(const PassChecks& checks, std::span<const PointScorer> scorers, double bound)
      : checks_(&checks), scorers_(scorers), bound_(bound) {}

  /// Of the tip half-way from point t to the next, mm.
  double Bend(size_t t, const Joints& from, const Joints& step) const {
    return HalfwayDeviation(checks_->CarrierFrom(t), from, from + step).position;
  }

  /// The step (rad) from point t at `q` to the pose at the next one on the same branch with the same
  /// freedoms, admissible or not; 0 where the arm has none: no excuse.
  Joints UnchangedStep(size_t t, const FreedomValues& freedoms, int branch, const Joints& q) const;

  /// mm: the bound, or `share` of the bend with the freedoms unchanged.
  double Most(double share, size_t t, const FreedomValues& freedoms, int branch, const Joints& q) const {
    return std::max(bound_, share * Bend(t, q, UnchangedStep(t, freedoms, branch, q)));
  }

  double bound() const { return bound_; }

 private:
  const PassChecks* checks_;
  std::span<const PointScorer> scorers_;
  double bound_;
};

/// Of the bend with the freedoms unchanged that a search may choose, and smoothing leave.
inline constexpr double kSearchedBend = 1.2, kSmoothedBend = 1.25;

}  // namespace millpose
