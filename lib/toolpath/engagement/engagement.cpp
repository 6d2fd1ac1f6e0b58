// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/engagement/engagement.hpp"

#include <algorithm>
#include <cassert>

#include "base/parallel.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "geometry/mesh/bvh.hpp"
#include "toolpath/engagement/drilled.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr int kStepsOfDepth = 4;     // slices of a layer's depth
constexpr int kProbes = 8;           // places around the cutter where higher material is looked for
constexpr double kSlotShare = 0.95;  // of the diameter: a wider cut is a slot
constexpr int kPeakSteps = 720;
constexpr double kAcross = 0.1;  // cosine of normal and axis: below it the cutter mills with its side

/// The edge of a contour has its normal across the tool's axis: depth then counts along the axis.
bool MillsWithItsSide(const MillingPoint& point) { return point.normal.dot(point.tool_axis) < kAcross; }

/// How much farther up the axis than elsewhere it is asked what stands at a point.
double AskedAbove(const EngagementOptions& options, const MillingPoint& point) {
  return MillsWithItsSide(point) ? options.edge.cutter.length : 0.0;
}

/// A point's cut as it is worked out.
struct PointCut {
  CutterStance stance;
  std::vector<EdgeSlice> slices;
  std::vector<EngagedArc> arcs;
};

class Cutting {
 public:
  Cutting(const EngagementOptions& options, const Toolpath& toolpath)
      : options_(options), swept_(options.edge.cutter, toolpath) {}

  PointCut CutAt(const MillingPoint& point, size_t number) const {
    PointCut cut{StanceOf(point), {}, {}};
    if (options_.stated) {
      cut.slices = Slices(point, options_.depth);
      cut.arcs = EngagedArcs(cut.slices, cut.stance, Stated(point, cut.stance));
      return cut;
    }
    const bool side = MillsWithItsSide(point);
    SweptPath::Near before = swept_.Before(number, point.position, point.normal, AskedAbove(options_, point));
    const InMaterial stands = [&](const Vector3d& place) {
      // In this order: what was milled before costs less to ask than the stock.
      return !swept_.Removed(before, place) && options_.stock(place);
    };
    cut.slices =
        side ? SliceEdge(options_.edge.cutter, options_.edge.cutter.length, options_.depth / kStepsOfDepth)
             : Slices(point, HeightAt(point, cut.stance, stands));
    cut.arcs = EngagedArcs(cut.slices, cut.stance, stands);
    return cut;
  }

  Engagement EngagementOf(const MillingPoint& point, const PointCut& cut) const {
    Engagement result;
    if (cut.arcs.empty()) return result;
    result.force = MeanForce(options_.edge, cut.slices, cut.stance, cut.arcs);
    double left = 0, right = 0;
    for (const auto& [from, to] : CutWidths(cut.slices, cut.arcs)) {
      left += std::max(0.0, to) - std::max(0.0, from);
      right += std::min(0.0, to) - std::min(0.0, from);
    }
    result.width = left + right;
    result.side = result.width >= kSlotShare * 2 * options_.edge.cutter.radius ? CutSide::kSlot
                  : left >= right                                              ? CutSide::kUp
                                                                               : CutSide::kDown;
    result.force *= options_.FactorOf(result.side);
    for (const EngagedArc& arc : cut.arcs) result.depth = std::max(result.depth, TopOf(point, cut, arc));
    return result;
  }

 private:
  CutterStance StanceOf(const MillingPoint& point) const {
    return {point.position, point.feed, point.tool_axis,
            point.feed_rate / (options_.spindle_speed * options_.edge.teeth)};
  }

  /// How far a leaning cutter's contact lies below its tip, along the normal (TipAtContact).
  double ContactBelow(const MillingPoint& point) const {
    const CutterShape& cutter = options_.edge.cutter;
    const double cosine = std::min(1.0, point.normal.dot(point.tool_axis));
    const double sine = std::sqrt((1 - cosine) * (1 + cosine));
    return cutter.corner_radius * (1 - cosine) + (cutter.radius - cutter.corner_radius) * sine;
  }

  std::vector<EdgeSlice> Slices(const MillingPoint& point, double height) const {
    // A leaning cutter has edges at a height of the part that lie farther up its axis on the other side.
    const double cosine = point.normal.dot(point.tool_axis);
    const double sine = std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
    const double along = (height + 2 * options_.edge.cutter.radius * sine) / std::max(0.1, cosine);
    return SliceEdge(options_.edge.cutter, along, options_.depth / kStepsOfDepth);
  }

  /// The layer's depth, or more where material stands higher.
  double HeightAt(const MillingPoint& point, const CutterStance& stance, const InMaterial& stands) const {
    const double cosine = point.normal.dot(point.tool_axis), limit = options_.edge.cutter.length;
    const Vector3d left = stance.Across(), ahead = left.cross(stance.axis);
    double height = options_.depth;
    const auto higher = [&] {
      for (int i = 0; i < kProbes; ++i) {
        const auto [s, c] = SinCos(kPi * (i + 0.5) / kProbes);
        const Vector3d place = stance.tip + options_.edge.cutter.radius * (s * ahead + c * left) +
                               (height + 0.5 * options_.depth) / std::max(0.1, cosine) * stance.axis;
        if (stands(place)) return true;
      }
      return false;
    };
    while (height < limit && higher()) height += options_.depth;
    return height;
  }

  InMaterial Stated(const MillingPoint& point, const CutterStance& stance) const {
    const Vector3d left = stance.Across(), tip = stance.tip, normal = point.normal;
    const double free = options_.edge.cutter.radius - options_.stated->width;
    const double top = options_.depth - ContactBelow(point);
    const MillingSide side = options_.stated->side;
    return [=](const Vector3d& place) {
      if ((place - tip).dot(normal) > top) return false;
      const double beside = (place - tip).dot(left);
      return side == MillingSide::kSlot || (side == MillingSide::kUp ? beside > free : -beside > free);
    };
  }

  /// How high above the surface at the point an arc's slice reaches, mm along the normal; along the axis
  /// above the tip where the cutter mills with its side.
  double TopOf(const MillingPoint& point, const PointCut& cut, const EngagedArc& arc) const {
    const EdgeSlice& slice = cut.slices[arc.slice];
    if (MillsWithItsSide(point)) return slice.height + 0.5 * slice.length * slice.sin_lead;
    const Vector3d left = cut.stance.Across(), ahead = left.cross(cut.stance.axis);
    const auto [s, c] = SinCos(0.5 * (arc.start + arc.end));
    const Vector3d place = slice.radius * (s * ahead + c * left) +
                           (slice.height + 0.5 * slice.length * slice.sin_lead) * cut.stance.axis;
    return place.dot(point.normal) + ContactBelow(point);
  }

  const EngagementOptions& options_;
  SweptPath swept_;
};

}  // namespace

void SetEngagement(const EngagementOptions& options, int threads, const std::stop_token& stop,
                   Toolpath& toolpath, const std::vector<std::vector<char>>& of) {
  if (options.drill) return SetDrilledEngagement(options, threads, stop, toolpath, of);
  const Cutting cutting(options, toolpath);
  std::vector<std::pair<MillingPoint*, size_t>> points;  // with their numbers in the job
  size_t number = 0;
  for (size_t p = 0; p < toolpath.passes.size(); ++p)
    for (size_t t = 0; t < toolpath.passes[p].points.size(); ++t, ++number)
      if (of.empty() || of[p][t] != 0) points.emplace_back(&toolpath.passes[p].points[t], number);
  ParallelFor(points.size(), threads, stop, [&](size_t i) {
    const auto [point, at] = points[i];
    if (point->gouge > 0) {
      point->engagement = {};
    } else {
      point->engagement = cutting.EngagementOf(*point, cutting.CutAt(*point, at));
    }
  });
}

namespace {

/// Boxes of the tips on all motions from and to points with a gouge.
std::vector<Eigen::AlignedBox3d> MissingMotions(const Toolpath& toolpath) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const Pass& pass : toolpath.passes) {
    const size_t count = pass.points.size();
    for (size_t i = 0; i < count; ++i) {
      const size_t next = i + 1 < count ? i + 1 : pass.closed ? 0 : i;
      if (!(pass.points[i].gouge > 0) && !(pass.points[next].gouge > 0)) continue;
      boxes.emplace_back(pass.points[i].position);
      boxes.back().extend(pass.points[next].position);
    }
  }
  return boxes;
}

}  // namespace

void SetEngagementBesideMissing(const EngagementOptions& options, int threads, const std::stop_token& stop,
                                Toolpath& toolpath) {
  assert(!options.drill);
  const Bvh missing(options.stated ? std::vector<Eigen::AlignedBox3d>() : MissingMotions(toolpath));
  std::vector<std::vector<char>> of;
  for (const Pass& pass : toolpath.passes) {
    std::vector<char>& anew = of.emplace_back();
    for (const MillingPoint& point : pass.points) {
      anew.push_back(point.gouge > 0 ? 1 : 0);
      const Vector3d reach =
          Vector3d::Constant(SweptPath::Reach(options.edge.cutter, AskedAbove(options, point)));
      missing.ForEachIn({point.position - reach, point.position + reach}, [&](int) { anew.back() = 1; });
    }
  }
  SetEngagement(options, threads, stop, toolpath, of);
}

double EngagementOptions::FactorOf(CutSide side) const {
  switch (side) {
    case CutSide::kUp:
      return up_factor;
    case CutSide::kDown:
      return down_factor;
    case CutSide::kSlot:
      return slot_factor;
    case CutSide::kAir:
      break;
  }
  return 1;
}

CuttingForce HeaviestCut(const EngagementOptions& options, const Toolpath& toolpath) {
  if (options.drill) return HeaviestDrilledCut(options, toolpath);
  const MillingPoint* heaviest = nullptr;
  size_t number = 0, at = 0;
  for (const Pass& pass : toolpath.passes)
    for (const MillingPoint& point : pass.points) {
      if (!heaviest || point.engagement.force.norm() > heaviest->engagement.force.norm())
        heaviest = &point, at = number;
      ++number;
    }
  CuttingForce force{Vector3d::Zero(), 0, 0};
  if (!heaviest) return force;
  const PointCut cut = Cutting(options, toolpath).CutAt(*heaviest, at);
  const Vector3d left = cut.stance.Across(), ahead = left.cross(cut.stance.axis);
  const Vector3d& mean = heaviest->engagement.force;
  force.mean = {mean.dot(ahead), mean.dot(left), mean.dot(cut.stance.axis)};
  force.peak = PeakForce(options.edge, cut.slices, cut.stance, cut.arcs, kPeakSteps) *
               options.FactorOf(heaviest->engagement.side);
  double most = 0;
  for (size_t slice = 0; slice < cut.slices.size(); ++slice) {
    double arc = 0;
    for (const EngagedArc& one : cut.arcs)
      if (one.slice == slice) arc += one.end - one.start;
    most = std::max(most, arc);
  }
  force.engaged = options.edge.teeth * most / (2 * kPi);
  return force;
}

}  // namespace millpose
