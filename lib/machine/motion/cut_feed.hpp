// SPDX-License-Identifier: GPL-3.0-or-later
// What the joints do along a cut at its feed, and the feed that they can hold.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "machine/robot/arm.hpp"

namespace millpose {

/// One point of a cut.
struct CutSample {
  Joints q = Joints::Zero();                           ///< rad, continuous along the cut
  double arc_length = 0;                               ///< mm, increasing
  double feed = 0;                                     ///< mm/s, programmed
  Eigen::Vector3d external = Eigen::Vector3d::Zero();  ///< external axes that move along, mm or rad; others 0
};

/// How fast external axes can be, in the units of CutSample::external, and how fast faster; no bounds by
/// default.
struct ExternalBounds {
  Eigen::Vector3d speed = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d acceleration = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
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

/// A sample whose programmed feed the axes cannot hold.
struct FeedShortfall {
  int sample = 0;
  int joint = 0;  ///< 0..5: the one that limits most; 6 and on: an external axis
  bool by_acceleration = false;
  double feed_possible = 0;  ///< mm/s, at this sample by itself
};

/// Samples at which a constant programmed feed would exceed an axis's speed or acceleration.
std::vector<FeedShortfall> FindShortfalls(std::span<const CutSample> cut, const Joints& speed,
                                          const Joints& acceleration, const ExternalBounds& external = {});

/// The fastest feeds, mm/s, none above the programmed one, that every sample could hold without slowing down
/// and between which the feed changes no faster than speed and acceleration of the axes allow. Time-optimal
/// within that (reachability analysis after Pham and Pham 2018).
std::vector<double> ReducedFeeds(std::span<const CutSample> cut, const Joints& speed,
                                 const Joints& acceleration, const ExternalBounds& external = {});

}  // namespace millpose
