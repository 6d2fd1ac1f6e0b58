// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/plane_slices.hpp"
#include "toolpath/spread.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

// Where the region begins and ends along the planes' normal, and how its faces lie to the planes.
struct Extent {
  double lower = std::numeric_limits<double>::infinity(), upper = -std::numeric_limits<double>::infinity();
  std::vector<Stretch> stretches;
};

Extent ExtentOf(const Mesh& mesh, const Region& region, const Eigen::Vector3d& normal) {
  Extent extent;
  for (const Region::Patch& patch : region.Patches()) {
    Stretch stretch{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 1};
    for (const Eigen::Vector3d& p : patch.corners) {
      stretch.lower = std::min(stretch.lower, normal.dot(p));
      stretch.upper = std::max(stretch.upper, normal.dot(p));
    }
    // Across the planes a face rises by the sine of its angle with them.
    stretch.slope = 1 / std::max(1e-9, mesh.FaceNormal(patch.face).cross(normal).norm());
    extent.lower = std::min(extent.lower, stretch.lower);
    extent.upper = std::max(extent.upper, stretch.upper);
    extent.stretches.push_back(stretch);
  }
  return extent;
}

class ParallelPlanes : public Strategy {
 public:
  std::vector<Lane> Lanes(const Mesh& mesh, const Region& region, const ToolpathOptions& options,
                          std::stop_token stop) const override {
    const Eigen::Vector3d normal = options.plane_normal;
    const Extent extent = ExtentOf(mesh, region, normal);
    double lower = extent.lower, upper = extent.upper;
    if (lower > upper) return {};
    if (upper - lower > 2 * options.region.rim_distance) {
      lower += options.region.rim_distance;
      upper -= options.region.rim_distance;
    }
    // The way that slices run where the surface faces as most of the region does.
    Eigen::Vector3d along = normal.cross(region.MeanNormal());
    if (along.norm() < 1e-6) along = normal.unitOrthogonal();
    const std::vector<double> offsets =
        options.stepover_on_surface ? SpreadOnSurface(extent.stretches, lower, upper, options.stepover)
                                    : SpreadEvenly(lower, upper, options.stepover);
    std::vector<Lane> lanes;
    for (auto& curves : SliceByPlanes(mesh, normal, offsets, stop)) {
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
