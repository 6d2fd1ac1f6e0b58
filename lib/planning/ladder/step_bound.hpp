// SPDX-License-Identifier: GPL-3.0-or-later
// How far the joints may turn between neighbouring points: by the way between them, and by the time that the
// feed leaves.
#pragma once

#include <limits>
#include <span>

#include "base/units.hpp"
#include "machine/robot/arm.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

/// A job's bounds of the joint steps; a step keeps them all.
struct StepBounds {
  double per_mm = DegToRad(2);  ///< rad a mm of way (ToolWay)
  double speed_share = 0.25;    ///< of each joint's largest speed, at the programmed feed
  Joints most = Joints::Constant(std::numeric_limits<double>::infinity());  ///< rad a step
};

/// The way of the tool between two points, mm: of its tip, or of a point kLever up its axis where the tool
/// turns on the spot.
double ToolWay(const MillingPoint& from, const MillingPoint& to);
inline constexpr double kLever = 300;  ///< mm

/// Largest step of each joint from one point to another, rad; at most half a turn. Speeds of 0 are
/// unknown.
Joints StepBound(const StepBounds& bounds, const Arm& arm, const MillingPoint& from, const MillingPoint& to);

/// That of every step along a pass: entry t from point t to the next, the last to the first.
std::vector<Joints> StepBoundsAlong(const StepBounds& bounds, const Arm& arm,
                                    std::span<const MillingPoint> points);

}  // namespace millpose
