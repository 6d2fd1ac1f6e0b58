// SPDX-License-Identifier: GPL-3.0-or-later
// How smoothly the joints run along the cuts of a plan, and the feeds that they can hold.
#pragma once

#include <vector>

#include "planning/result/plan_result.hpp"

namespace millpose {

/// A point whose programmed feed the axes cannot hold.
struct FeedFinding {
  int pass = 0;
  size_t point = 0;  ///< number in the job
  int joint = 0;     ///< 0..5; 6 and on: an external axis
  bool by_acceleration = false;
  double feed = 0;           ///< mm/s, programmed
  double feed_possible = 0;  ///< mm/s, at this point by itself
};

/// Figures over all pieces of a plan.
struct ContinuityFigures {
  Joints speed_share = Joints::Zero();         ///< largest joint speed ÷ the joint's own
  Joints acceleration_share = Joints::Zero();  ///< largest joint acceleration ÷ the joint's own
  Joints acceleration_rms = Joints::Zero();    ///< rad/s², over the time of all cuts
  double wrist = 1, elbow = 1;                 ///< smallest sines, see SingularityDistance
  double shoulder = 0;                         ///< mm, smallest; 0 without points
  double halfway_deviation = 0;            ///< mm, tip, largest between joint and straight motion half-way
  double halfway_axis = 0;                 ///< rad, tool axis, likewise
  std::vector<FeedFinding> feed_not_held;  ///< in the order of the points
};
ContinuityFigures AnalyseContinuity(const PlanResult& plan);

/// ∫ Σ_joints (d²q/dt²)² dt over the pieces of a pass at their feeds, rad²/s³.
double SquaredAcceleration(const PassResult& pass);

/// Neighbouring points of one piece whose feed was reduced to less than kSlowShare.
struct SlowStretch {
  int pass = 0;
  size_t first = 0, last = 0;  ///< numbers in the job
  int joint = 0;               ///< 0..5: the one that limits most; 6 and on: an external axis
  bool by_acceleration = false;
  double feed = 0;    ///< mm/s, the lowest of them
  double wanted = 0;  ///< mm/s, programmed there

  double Share() const { return feed / wanted; }
};

/// "A3", or the name of an external axis: of the number in FeedFinding and SlowStretch.
std::string AxisName(const std::vector<ExternalAxis>& external, int axis);

inline constexpr double kSlowShare = 0.7;  ///< of the programmed feed: less is worth telling

/// What ReduceFeeds did.
struct FeedReduction {
  size_t points = 0;              ///< whose feed is lower now
  double least = 0;               ///< mm/s, the lowest feed; 0 when none was reduced
  std::vector<SlowStretch> slow;  ///< in the order of the points
};

/// Lowers the feeds of the points to what the joints can hold, changing no faster than they can follow
/// (ReducedFeeds), and so that no joint exceeds 95 % of its speed on the straight motion to the point, nor an
/// external axis 99 %. Feeds
/// that can be held stay as they are.
FeedReduction ReduceFeeds(PlanResult& plan);

}  // namespace millpose
