// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/plane_slices.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

// Where the region begins and ends along the planes' normal. Borders that carry a rim distance move inwards
// by it.
std::pair<double, double> Extent(const Region& region, const Eigen::Vector3d& normal) {
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  for (const auto& patch : region.Patches())
    for (const Eigen::Vector3d& p : patch) {
      lower = std::min(lower, normal.dot(p));
      upper = std::max(upper, normal.dot(p));
    }
  return {lower, upper};
}

class ParallelPlanes : public Strategy {
 public:
  std::vector<Lane> Lanes(const Mesh& mesh, const Region& region, const ToolpathOptions& options,
                          std::stop_token stop) const override {
    const Eigen::Vector3d normal = options.plane_normal;
    auto [lower, upper] = Extent(region, normal);
    if (lower > upper) return {};
    if (upper - lower > 2 * options.region.rim_distance) {
      lower += options.region.rim_distance;
      upper -= options.region.rim_distance;
    }
    // The way that slices run where the surface faces as most of the region does.
    Eigen::Vector3d along = normal.cross(region.MeanNormal());
    if (along.norm() < 1e-6) along = normal.unitOrthogonal();
    std::vector<Lane> lanes;
    for (auto& curves : SliceByPlanes(mesh, normal, SpreadEvenly(lower, upper, options.stepover), stop)) {
      const bool backwards = options.zigzag && lanes.size() % 2 == 1;
      lanes.push_back(
          {std::move(curves), [along](const Eigen::Vector3d& p) { return along.dot(p); }, backwards});
    }
    return lanes;
  }
};

}  // namespace

std::unique_ptr<Strategy> MakeParallelPlanes() { return std::make_unique<ParallelPlanes>(); }

}  // namespace millpose
