// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/parallel_planes.hpp"

#include "geometry/slice/plane_slices.hpp"
#include "toolpath/strategies/spread.hpp"
#include "toolpath/strategies/stepover.hpp"
#include "toolpath/strategy_entry.hpp"

namespace millpose {
namespace {

std::pair<double, double> Range(const Region::Patch& patch, const Eigen::Vector3d& normal) {
  double from = std::numeric_limits<double>::infinity(), to = -from;
  for (const Eigen::Vector3d& p : patch.corners) {
    from = std::min(from, normal.dot(p));
    to = std::max(to, normal.dot(p));
  }
  return {from, to};
}

}  // namespace

Layout ParallelPlanes::Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const {
  RequireUnit(normal, "the planes' normal");
  Layout layout;
  StepoverRule rule(region.mesh(), options);
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  std::vector<Stretch> stretches;
  double rising =
      0;  // area times the position's rise on it: the way of all passes is as long, by their density
  for (const Region::Patch& patch : region.Patches()) {
    const auto [from, to] = Range(patch, normal);
    stretches.push_back({from, to, rule.Density(patch.face, normal)});
    const double across = normal.dot(region.mesh().FaceNormal(patch.face));
    rising += AreaInside(region, patch) * std::sqrt(std::max(0.0, 1 - across * across));
    lower = std::min(lower, from);
    upper = std::max(upper, to);
  }
  if (lower > upper) return layout;
  rule.AddNotes(layout.notes);
  if (upper - lower > 2 * options.region.rim_distance) {
    lower += options.region.rim_distance;
    upper -= options.region.rim_distance;
  }
  const PassScale scale(stretches, lower, upper);
  CheckBudget(options, {scale.wanted(), upper > lower ? rising * scale.wanted() / (upper - lower) : 0});
  // The way that slices run where the surface faces as most of the region does.
  Eigen::Vector3d along = normal.cross(region.MeanNormal());
  if (along.norm() < 1e-6) along = normal.unitOrthogonal();
  for (auto& curves : SliceByPlanes(region.mesh(), normal, scale.Positions(), stop)) {
    CurveGroup lane;
    lane.curves = std::move(curves);
    lane.progress = [along](const Eigen::Vector3d& p) { return along.dot(p); };
    lane.advance = [across = normal](const Eigen::Vector3d& p) { return across.dot(p); };
    lane.backwards = layout.lanes.size() % 2 == 1;
    layout.lanes.push_back(std::move(lane));
  }
  return layout;
}

StrategyEntry ParallelPlanesEntry() {
  using S = ParallelPlanes;
  using namespace yaml;
  return EntryOf<S>("planes", "Strategy parallel_planes.",
                    Section<S>({Key<S>("normal", MILLPOSE_AT(normal), yaml::Direction(),
                                       "Normal of the planes, in the workpiece frame.")
                                    .Required()}));
}

}  // namespace millpose
