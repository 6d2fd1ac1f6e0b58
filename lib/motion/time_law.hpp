// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "robot/arm.hpp"

namespace millpose {

/// Rest-to-rest motion straight in joint space (PTP): all axes share one course of the way, speeding up
/// evenly, running evenly, slowing down evenly, as fast as the joints allow.
struct TimeLaw {
  double speed = 0;         ///< of the way's share, 1/s, while running
  double acceleration = 0;  ///< 1/s²
  double duration = 0;      ///< s; 0 for no motion

  /// Share of the way, 0..1, done after `time` s.
  double Share(double time) const;
};

/// The fastest law for a turn by `delta` (rad) within `speed` (rad/s) and `acceleration` (rad/s²), both
/// positive.
TimeLaw FastestLaw(const Joints& delta, const Joints& speed, const Joints& acceleration);

/// Time for a path of straight joint motions with a stop at every corner, s.
double PathDuration(std::span<const Joints> corners, const Joints& speed, const Joints& acceleration);

}  // namespace millpose
