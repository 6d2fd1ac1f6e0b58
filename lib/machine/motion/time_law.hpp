// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "machine/robot/arm.hpp"

namespace millpose {

/// The course of one motion: all axes share one way, speeding up evenly from rest, running evenly, slowing
/// down evenly to rest; an end that is passed without a stop has no ramp.
struct TimeLaw {
  double speed = 0;         ///< of the way's share, 1/s, while running
  double acceleration = 0;  ///< 1/s²; 0: no ramps
  double duration = 0;      ///< s; 0 for no motion
  bool from_rest = true, to_rest = true;

  /// Share of the way, 0..1, done after `time` s.
  double Share(double time) const;
  /// Its change, 1/s.
  double Rate(double time) const;
};

/// The fastest rest-to-rest law, straight in joint space (PTP), for a turn by `delta` (rad) within `speed`
/// (rad/s) and `acceleration` (rad/s²), both positive.
TimeLaw FastestLaw(const Joints& delta, const Joints& speed, const Joints& acceleration);

/// The law of a motion that takes `seconds` (above 0) when running evenly, and whose ramps take `ramp` s each
/// where it begins or ends at rest; a motion too short for them stays slower.
TimeLaw FeedLaw(double seconds, double ramp, bool from_rest, bool to_rest);

/// Time for a path of straight joint motions with a stop at every corner, s.
double PathDuration(std::span<const Joints> corners, const Joints& speed, const Joints& acceleration);

}  // namespace millpose
