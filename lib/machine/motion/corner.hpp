// SPDX-License-Identifier: GPL-3.0-or-later
// The corner between two straight motions: how far a control that rounds it leaves it, how much rounding a
// tolerance allows, and how fast it can be passed. A model: controls do not publish their curve. Rounding is
// taken as a parabola that begins and ends at the same distance ("reach") from the corner, tangent to both
// motions there; it never reaches beyond the middle of either motion.
#pragma once

#include <optional>

#include "machine/robot/arm.hpp"

namespace millpose {

/// How far the tool may be from its programmed path.
struct PathTolerance {
  double position = 0.02;        ///< mm, of the tip
  double angle = 0.00034906585;  ///< rad (0.02°), of the tool's orientation
};

/// Writers of programs keep to this share of the tolerance that verification then allows: the rest is for
/// rounding in texts.
inline constexpr double kWrittenShare = 0.8;

/// What writers keep to where verification allows `verified`.
PathTolerance WrittenTolerance(const PathTolerance& verified);

/// A corner as a control sees it.
struct Corner {
  double shorter = 0;  ///< mm, the shorter of the two motions
  double bend = 0;     ///< |u₂ − u₁| of the two directions of travel, 0..2
  double twist = 0;    ///< |w₂ − w₁| of the two rotations per mm of travel, rad/mm
};

/// The corner at `corner` of the straight motions before → corner → after. Where one of them has no length
/// nothing can be rounded: all fields are 0.
Corner CornerBetween(const Pose& before, const Pose& corner, const Pose& after);

/// How far a rounded corner may leave the corner itself.
struct CornerRounding {
  double position = 0;  ///< mm
  double angle = 0;     ///< rad
};

/// Deviation of a rounding that begins `reach` mm before the corner, at most at half of the shorter motion:
/// reach/4·bend, reach/4·twist.
CornerRounding RoundedBy(const Corner& corner, double reach);

/// The largest reach (mm) whose deviation stays within the tolerance; at most half of the shorter motion.
double LargestReach(const Corner& corner, const PathTolerance& tolerance);

/// What bounds the speed of a control along short straight motions.
struct PathDynamics {
  double cycle = 0.012;                     ///< s, interpolation cycle: a rounding lasts one at least
  double block_time = 0.012;                ///< s, shortest time per motion
  double acceleration = 2300;               ///< mm/s², of the tip
  std::optional<double> turn_acceleration;  ///< rad/s², of the tool; empty: no bound
};

/// The speed (mm/s) at which a corner can be passed with this reach: the rounding takes one cycle per reach
/// at least, and the velocity changes from one motion's to the next within 2·reach of travel at no more than
/// the acceleration. 0 without reach: an exact stop. An estimate.
double CornerSpeed(const Corner& corner, double reach, const PathDynamics& dynamics);

/// The speed (mm/s) at which motions of this length (mm) can follow each other. An estimate.
double BlockSpeed(double length, const PathDynamics& dynamics);

/// s that the slowest joint needs to stop from the faster of two speeds (rad/s).
double StopTime(const Joints& before, const Joints& after, const Joints& acceleration);

/// How far (rad, joint by joint) the joints are from a corner that a control passes by overlapping the
/// slowing down of one motion with the speeding up of the next (LinuxCNC): a parabola over the time t that
/// the slowest joint needs to stop, no longer than the shorter motion takes, leaves it by t/8 of the change
/// of speed. Speeds in rad/s, `shorter` in s.
Joints OverlapRounding(const Joints& before, const Joints& after, const Joints& acceleration, double shorter);

}  // namespace millpose
