// SPDX-License-Identifier: GPL-3.0-or-later
// Figures along a tool path as a chart on paper (SVG).
#pragma once

#include <string>
#include <vector>

namespace millpose {

/// One figure of every point, in the unit that the chart shows; NaN where a point has none.
struct PathSeries {
  std::string name, colour;
  std::vector<double> values;
};

struct PathCurves {
  std::string title, unit;
  std::vector<double> way;  ///< mm, of every point, from where the first pass begins; never falls
  std::vector<PathSeries> series;
  std::vector<std::pair<double, std::string>> parts = {};  ///< where an operation begins, mm, and its number
  std::vector<double> left_out = {};                       ///< where points are skipped, mm
  std::string note = {};                                   ///< a sentence below the title
};

/// The chart, `height` px of 720 wide: of all points that share a pixel the largest value, so that no peak is
/// lost and the text stays as short for any number of points; no line where points have no figure; skipped
/// points as red ticks. `title`: that of the curves in the page's language; empty: as it stands. A pure
/// function.
std::string CurvesSvg(const PathCurves& curves, double height, const std::string& title = {});

/// The finest step of 1, 2 or 5 times a power of ten that parts `range` (above 0) into at most `most` parts.
double RoundStep(double range, int most);

}  // namespace millpose
