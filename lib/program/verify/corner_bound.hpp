// SPDX-License-Identifier: GPL-3.0-or-later
// Corners whose path the maker of a controller does not document: what is known of them all the same.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "machine/motion/corner.hpp"
#include "program/verify/compare.hpp"

namespace millpose {

/// By how much the rounded corners of a program may leave its programmed path, as far as anybody knows.
struct CornerBound {
  double position = 0, angle = 0;  ///< mm, rad: the largest of all corners
  std::string assumption;          ///< under which they are bounds: MotionProgram::corner_assumption
};

/// The most that any path may leave the programmed one by which leaves it `reach` mm before a corner at the
/// earliest, is back on it `reach` mm behind at the latest, and stays within the convex hull of what it cuts
/// off: tip (mm), rotation vector (rad) and length of path together. `tools`: the places before and behind,
/// `corner` the index of the corner among them. One corner within reach: its distance from the line between
/// the two ends, of its turn from what turns evenly between theirs; with several, twice the farthest one's.
CornerRounding WithinReach(const std::vector<Pose>& tools, size_t corner, double reach);

/// The bound of the corner at which motion `i` ends, both 0 where it is none in a cut or not rounded.
/// Precondition: the program has a corner_assumption.
CornerRounding CornerBoundAt(const Replayed& replayed, const Cell& cell, size_t i);

/// Finds the corners that the maker does not document and whose bounds are wider than `max_corner` and the
/// angle's tolerance. Returns the widest (mm).
double CheckCornerBounds(const Replayed& replayed, const Cell& cell, const VerifyOptions& options,
                         std::vector<Finding>& findings);

/// The largest; empty where the maker documents the corners, or none is rounded.
std::optional<CornerBound> FindCornerBound(const MotionProgram& program, const Cell& cell);

/// "the corner's path, bounded by 0.0123 mm and 0.0045 deg, provided that …".
std::string Describe(const CornerBound& bound);

}  // namespace millpose
