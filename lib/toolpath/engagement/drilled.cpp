// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/drilled.hpp"

#include <algorithm>
#include <limits>

#include "base/parallel.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr int kLipRings = 64;      // that the lips are looked at in
constexpr int kPlacesOfRing = 8;   // where the stock is asked
constexpr double kJustCut = 1e-3;  // mm above the lips: what they have cut last

class DrilledPass {
 public:
  explicit DrilledPass(const EngagementOptions& options) : options_(options), lips_(*options.drill) {}

  void Set(Pass& pass, const std::vector<char>* of) const {
    double lowest = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < pass.points.size(); ++i) {
      MillingPoint& point = pass.points[i];
      const double height = point.position.dot(point.tool_axis);
      const bool deeper = i > 0 && height < lowest;
      lowest = std::min(lowest, height);
      if ((of && (*of)[i] == 0) || (!options_.stock && !point.own)) continue;
      point.engagement = deeper && point.gouge <= 0 ? Cut(point) : Engagement{};
    }
  }

 private:
  Engagement Cut(const MillingPoint& point) const {
    const double ring = 0.5 * lips_.diameter / kLipRings;
    Engagement cut;
    for (int k = 0; k < kLipRings; ++k) {
      const double share = Share(point, ring * (k + 0.5));
      if (share <= 0) continue;
      cut.depth += ring * share;
      cut.width = 2 * ring * (k + 1);
    }
    if (cut.depth <= 0) return {};
    cut.side = CutSide::kSlot;
    const double per_tooth = point.feed_rate / (options_.spindle_speed * lips_.teeth);
    cut.force = LoadOfDrill(lips_, cut.width, cut.depth, per_tooth).thrust * point.tool_axis;
    return cut;
  }

  /// Of a ring of the lips, how much has come through material.
  double Share(const MillingPoint& point, double radius) const {
    const double height = lips_.Height(radius) + kJustCut;
    if (!options_.stock) return height < point.own->top && height > point.own->out ? 1 : 0;
    const Vector3d across = point.tool_axis.unitOrthogonal(), beside = point.tool_axis.cross(across);
    int standing = 0;
    for (int i = 0; i < kPlacesOfRing; ++i) {
      const auto [s, c] = SinCos(2 * kPi * i / kPlacesOfRing);
      standing +=
          options_.stock(point.position + radius * (c * across + s * beside) + height * point.tool_axis);
    }
    return static_cast<double>(standing) / kPlacesOfRing;
  }

  const EngagementOptions& options_;
  const DrillLips& lips_;
};

}  // namespace

void SetDrilledEngagement(const EngagementOptions& options, int threads, const std::stop_token& stop,
                          Toolpath& toolpath, const std::vector<std::vector<char>>& of) {
  const DrilledPass drilled(options);
  ParallelFor(toolpath.passes.size(), threads, stop,
              [&](size_t p) { drilled.Set(toolpath.passes[p], of.empty() ? nullptr : &of[p]); });
}

CuttingForce HeaviestDrilledCut(const EngagementOptions& options, const Toolpath& toolpath) {
  CuttingForce heaviest{Vector3d::Zero(), 0, 0};
  for (const Pass& pass : toolpath.passes)
    for (const MillingPoint& point : pass.points)
      heaviest.peak = std::max(heaviest.peak, point.engagement.force.norm());
  heaviest.mean.z() = heaviest.peak;
  if (heaviest.peak > 0) heaviest.engaged = options.drill->teeth;
  return heaviest;
}

}  // namespace millpose
