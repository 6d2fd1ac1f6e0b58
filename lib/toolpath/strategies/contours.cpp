// SPDX-License-Identifier: GPL-3.0-or-later
// Lines of equal distance from the region's rims, one inside the other.
#include "base/parallel.hpp"
#include "toolpath/strategies/level_lines.hpp"
#include "toolpath/strategies/spread.hpp"
#include "toolpath/strategy_entry.hpp"

namespace millpose {
namespace {

class Contours final : public SurfaceStrategy {
 public:
  std::string Name() const override { return "contours"; }
  bool IsLaidFromBorders() const override { return true; }
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
      CurveGroup lane;
      lane.curves = lines.At(level, stop);
      lane.advance = distance;
      layout.lanes.push_back(std::move(lane));
    }
    return layout;
  }
};

}  // namespace

StrategyEntry ContoursEntry() { return EntryOf<Contours>(); }

}  // namespace millpose
