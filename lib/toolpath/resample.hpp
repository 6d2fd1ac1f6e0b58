// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/slice/curve.hpp"

namespace millpose {

/// A point of a curve: piece and parameter, with its length from the curve's start (mm).
struct CurvePoint {
  int piece = 0;
  double t = 0;
  double arc_length = 0;
};

/// Points of a curve, first to last, such that the curve stays within `chord_tolerance` (mm) of the chords
/// between them and neighbours are at most `spacing` (mm along the curve) apart. Of a closed curve the last
/// point is not the first one again. Corners of the curve that matter come from Douglas and Peucker 1973 (at
/// half the tolerance, so that points put between them keep the whole); the rest is spread evenly. Every step
/// is then cut into `parts`, a power of two: what a smaller power gives are points of a larger one, bit for
/// bit.
std::vector<CurvePoint> Resample(const Curve& curve, double chord_tolerance, double spacing, int parts = 1);

}  // namespace millpose
