// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/drilling.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace millpose {

std::vector<double> EvenStrokes(double top, double bottom, double step, const SourceLocation& place) {
  constexpr double kMost = 10'000;
  if (!(step > 0)) throw InputError(place, fmt::format("a peck must be above 0 mm, found {} mm", step));
  if (!((top - bottom) / step <= kMost))
    throw InputError(place, fmt::format("pecks of {} mm are more than {} in one hole", step, kMost));
  std::vector<double> bottoms;
  for (int k = 1; top - k * step > bottom + 1e-9; ++k) bottoms.push_back(top - k * step);
  bottoms.push_back(bottom);
  return bottoms;
}

std::vector<double> ShrinkingStrokes(double reference, double first, double bottom, double less,
                                     const SourceLocation& place) {
  std::vector<double> bottoms{first};
  double stroke = reference - first;
  while (bottoms.back() > bottom + 1e-9) {
    const double rest = bottoms.back() - bottom;
    if (less > 0) stroke = std::max(stroke - less, less);
    if (!(stroke > 0) || bottoms.size() > 10'000)
      throw InputError(place, "the first depth of the hole gives no strokes, or more than 10000");
    if (rest <= stroke) {
      bottoms.push_back(bottom);
    } else if (rest < 2 * stroke) {
      bottoms.push_back(bottom + rest / 2);
      bottoms.push_back(bottom);
    } else {
      bottoms.push_back(bottoms.back() - stroke);
    }
  }
  bottoms.back() = bottom;
  return bottoms;
}

std::vector<double> Heights(const Drilling& drilling, const SourceLocation& place) {
  if (!(drilling.bottoms.back() < drilling.clearance))
    throw InputError(place, fmt::format("the hole's bottom ({} mm) is not below its clearance ({} mm)",
                                        drilling.bottoms.back(), drilling.clearance));
  std::vector<double> heights;
  for (const double bottom : drilling.bottoms) {
    heights.push_back(bottom);
    const bool last = bottom == drilling.bottoms.back();
    const bool chips = drilling.chip_retract > 0 && !last;
    heights.push_back(chips ? std::min(drilling.clearance, bottom + drilling.chip_retract)
                            : drilling.clearance);
  }
  return heights;
}

}  // namespace millpose
