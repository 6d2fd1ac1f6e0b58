// SPDX-License-Identifier: GPL-3.0-or-later
// Lines of equal distance from the region's rims, one inside the other.
#include "base/parallel.hpp"
#include "toolpath/level_lines.hpp"
#include "toolpath/spread.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

class Contours : public Strategy {
 public:
  Layout Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const override {
    Layout layout;
    if (!region.HasBorders()) return layout;
    const auto distance = [&region](const Eigen::Vector3d& p) { return region.BorderDistance(p); };
    LevelField field;
    field.value = [&region](int, const Eigen::Vector3d& p) { return region.BorderDistance(p); };
    LevelLines lines(region, field, options.stepover / 2, options.chord_tolerance, stop);
    if (lines.largest() <= options.region.rim_distance) return layout;
    for (const double level : SpreadEvenly(options.region.rim_distance, lines.largest(), options.stepover)) {
      CheckStop(stop);
      Lane lane;
      lane.curves = lines.At(level, stop);
      lane.advance = distance;
      layout.lanes.push_back(std::move(lane));
    }
    return layout;
  }
};

}  // namespace

std::unique_ptr<Strategy> MakeContours() { return std::make_unique<Contours>(); }

}  // namespace millpose
