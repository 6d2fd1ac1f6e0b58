// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "machine/robot/mechanism.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

/// Where the external axes are while a pass is milled: each goes evenly with the arc length from one position
/// to another, or stands.
struct ExternalCourse {
  ExternalPosition from, to;

  bool Moves() const { return from != to; }
  ExternalPosition At(double share) const;  ///< 0..1 of the way
  auto operator<=>(const ExternalCourse&) const = default;
};

/// That of axes which stand.
ExternalCourse StandingAt(const ExternalPosition& external);

/// Of each point of a pass.
std::vector<ExternalPosition> PositionsAlong(const ExternalCourse& course, const Pass& pass);

/// A closed pass as an open one whose last point is its first again: with moving axes its ends differ. Open
/// passes as they are.
Pass EndingWhereItBegan(Pass pass);

/// What the planner may ask of external axes in a cut.
struct CoordinatedBounds {
  double speed_share = 0.25;  ///< of each axis's speed, at the programmed feed
};

/// Whether every axis of a course keeps within the bounds on every segment of the pass: what it moves over
/// the segment's length at its feed.
bool IsSlowEnough(const ExternalCourse& course, const Pass& pass, const std::vector<ExternalAxis>& axes,
                  const CoordinatedBounds& bounds);

}  // namespace millpose
