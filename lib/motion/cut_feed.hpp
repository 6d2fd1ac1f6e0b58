// SPDX-License-Identifier: GPL-3.0-or-later
// What the joints do along a cut at its feed, and the feed that they can hold.
#pragma once

#include <span>
#include <vector>

#include "robot/arm.hpp"

namespace millpose {

/// One point of a cut.
struct CutSample {
  Joints q = Joints::Zero();  ///< rad, continuous along the cut
  double arc_length = 0;      ///< mm, increasing
  double feed = 0;            ///< mm/s, programmed
};

/// Speeds and accelerations of the joints, rad/s and rad/s², with the tip moving at the given feeds.
struct JointRates {
  std::vector<Joints> speed, acceleration;  ///< one entry per sample
};

/// Rates along a cut. dq/ds and d²q/ds² come from the parabola through each sample and its two neighbours;
/// the feed's own change along the cut counts.
JointRates RatesAlong(std::span<const CutSample> cut);

/// Root mean square of a joint's values, weighted by the time spent at each sample.
Joints TimeRms(std::span<const CutSample> cut, std::span<const Joints> values);

/// A sample whose programmed feed the joints cannot hold.
struct FeedShortfall {
  int sample = 0;
  int joint = 0;  ///< 0..5: the one that limits most
  bool by_acceleration = false;
  double feed_possible = 0;  ///< mm/s, at this sample by itself
};

/// Samples at which a constant programmed feed would exceed a joint's speed or acceleration.
std::vector<FeedShortfall> FindShortfalls(std::span<const CutSample> cut, const Joints& speed,
                                          const Joints& acceleration);

/// The fastest feeds, mm/s, none above the programmed one, that every sample could hold without slowing down
/// and between which the feed changes no faster than speed and acceleration of the joints allow. Time-optimal
/// within that (reachability analysis after Pham and Pham 2018).
std::vector<double> ReducedFeeds(std::span<const CutSample> cut, const Joints& speed,
                                 const Joints& acceleration);

}  // namespace millpose
