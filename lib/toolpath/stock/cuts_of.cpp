// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/stock/cuts_of.hpp"

namespace millpose {

CutsOfTool CutsOf(const Toolpath& toolpath, const CutterShape& cutter) {
  CutsOfTool cuts{cutter, {}};
  const auto milled = [](const MillingPoint& point) { return !(point.gouge > 0); };
  const auto place = [](const MillingPoint& point) -> CutterPlace {
    return {point.position, point.tool_axis};
  };
  for (const Pass& pass : toolpath.passes) {
    const std::vector<MillingPoint>& points = pass.points;
    for (size_t i = 0; i < points.size(); ++i) {
      if (!milled(points[i])) continue;
      // The first one of a stretch stands for the tool's way down to it.
      const bool joined = i > 0 && milled(points[i - 1]);
      cuts.motions.push_back({place(points[joined ? i - 1 : i]), place(points[i]), 0});
    }
    if (pass.closed && milled(points.front()) && milled(points.back()))
      cuts.motions.push_back({place(points.back()), place(points.front()), 0});
  }
  return cuts;
}

}  // namespace millpose
