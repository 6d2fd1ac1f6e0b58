// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/face/face_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/units.hpp"
#include "machine/identification/flatness.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kInPlane = 1e-6;  // mm
constexpr double kSameWay = 1e-9;  // of unit normals
constexpr double kMicrometres = 1000;

bool ArePlane(const std::vector<SurfaceRay>& rays) {
  if (rays.empty()) return false;
  const SurfaceRay& first = rays.front();
  return std::ranges::all_of(rays, [&](const SurfaceRay& ray) {
    return (ray.normal - first.normal).norm() < kSameWay &&
           std::abs(first.normal.dot(ray.origin - first.origin)) < kInPlane;
  });
}

/// Spread of values as they come.
class SpreadTally {
 public:
  void Add(double value) {
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
    sum_ += value;
    ++count_;
  }
  HeightSpread Spread() const {
    if (count_ == 0) return {};
    return {sum_ / static_cast<double>(count_), low_, high_};
  }

 private:
  double low_ = kInfinity, high_ = -kInfinity, sum_ = 0;
  size_t count_ = 0;
};

}  // namespace

FaceRays MakeFaceRays(const Region& region, double spacing) {
  FaceRays face{RaysOver(region, spacing), {}, spacing, false};
  face.next = NextRays(face.rays, spacing);
  face.plane = ArePlane(face.rays);
  return face;
}

std::vector<Vector3d> SurfaceOf(const FaceRays& rays, const std::vector<RayHeight>& heights) {
  std::vector<Vector3d> surface;
  for (size_t i = 0; i < heights.size(); ++i)
    if (heights[i].IsCut()) surface.push_back(rays.rays[i].origin + heights[i].height * rays.rays[i].normal);
  return surface;
}

FaceFigures FiguresOf(const FaceRays& rays, const std::vector<RayHeight>& heights,
                      const std::vector<RayHeight>& flawless, const std::vector<CutterMotion>& motions,
                      bool zone) {
  FaceFigures figures;
  SpreadTally of_heights, of_added;
  std::map<int, SpreadTally> of_passes;
  const auto counts = [&](size_t i) { return heights[i].IsCut() && flawless[i].IsCut(); };
  const auto pass_at = [&](size_t i) { return motions[static_cast<size_t>(heights[i].motion)].pass; };
  const auto added_at = [&](size_t i) { return heights[i].height - flawless[i].height; };
  for (size_t i = 0; i < heights.size(); ++i) {
    if (flawless[i].IsCut() && !heights[i].IsCut()) ++figures.standing;
    if (!counts(i)) continue;
    ++figures.rays;
    of_heights.Add(heights[i].height);
    of_added.Add(added_at(i));
    of_passes[pass_at(i)].Add(added_at(i));
    for (const int next : rays.next[i]) {
      const auto other = static_cast<size_t>(next);
      if (next < 0 || !counts(other) || pass_at(i) == pass_at(other)) continue;
      const double step = std::abs(added_at(other) - added_at(i));
      if (step > (figures.step ? figures.step->height : 0))
        figures.step = {step, i, other, pass_at(i), pass_at(other)};
    }
  }
  figures.heights = of_heights.Spread();
  figures.added = of_added.Spread();
  for (const auto& [pass, tally] : of_passes) {
    const double range = tally.Spread().high - tally.Spread().low;
    if (!figures.within || range > figures.within->range) figures.within = {range, pass};
  }
  if (!rays.plane) return figures;
  const std::vector<Vector3d> surface = SurfaceOf(rays, heights);
  if (const std::optional<Flatness> fit = zone ? MeasureFlatness(surface) : FitPlane(surface)) {
    figures.flatness = fit->flatness;
    if (zone) figures.minimum_zone = fit->minimum_zone;
  }
  return figures;
}

std::string FaceCsv(const FaceRays& rays, const std::vector<RayHeight>& heights) {
  std::string csv = "x_mm,y_mm,z_mm,error_um\n";
  for (size_t i = 0; i < heights.size(); ++i) {
    if (!heights[i].IsCut()) continue;
    const Vector3d p = rays.rays[i].origin + heights[i].height * rays.rays[i].normal;
    csv += fmt::format("{:.17g},{:.17g},{:.17g},{:.17g}\n", p.x(), p.y(), p.z(),
                       kMicrometres * heights[i].height);
  }
  return csv;
}

}  // namespace millpose
