// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace millpose {

/// Positions spread evenly over lower..upper, `count` = the least that keeps their distance at or below
/// `stepover`; the first and last lie half a distance inside.
std::vector<double> SpreadEvenly(double lower, double upper, double stepover);

/// A stretch of surface that spans lower..upper of the position (of planes or radii); from one to the other
/// the way on the surface is `slope` (≥ 1) times as long.
struct Stretch {
  double lower = 0, upper = 0, slope = 1;
};

/// Positions over lower..upper such that the way on the surface between neighbours is the same everywhere and
/// at most `stepover`: even steps of the integral of the largest slope at each position. Slopes count up to
/// 20 (a surface nearly along the planes has no useful step-over).
std::vector<double> SpreadOnSurface(const std::vector<Stretch>& stretches, double lower, double upper,
                                    double stepover);

/// The step-over at which a ball of radius `radius` (mm) leaves scallops of height `height` (mm) on a flat:
/// 2 √(2 R h − h²); the width of the ball where h ≥ R.
double StepoverForScallop(double radius, double height);

}  // namespace millpose
