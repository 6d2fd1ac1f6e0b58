// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/pass_ends.hpp"

#include "base/error.hpp"
#include "base/trig.hpp"

namespace millpose {
namespace {

// A way of leaving a pass: places in units of (outwards along the pass, along the normal), beginning at the
// end.
std::vector<Eigen::Vector2d> LeadWay(const PassEnds& ends, double spacing) {
  std::vector<Eigen::Vector2d> corners{{0, 0}};
  if (ends.overrun > 0) corners.emplace_back(ends.overrun, 0);
  const Eigen::Vector2d from = corners.back();
  if (ends.lead == LeadShape::kNormal) corners.emplace_back(from.x(), ends.lead_length);
  if (ends.lead == LeadShape::kRamp) {
    const SineCosine ramp = SinCos(ends.ramp_angle);
    corners.emplace_back(from + ends.lead_length * Eigen::Vector2d(ramp.cos, ramp.sin));
  }
  if (ends.lead == LeadShape::kArc) {
    constexpr int kSteps = 12;  // 7.5° each: chords deviate by 0.2 % of the radius
    for (int k = 1; k <= kSteps; ++k) {
      const SineCosine turn = SinCos(kPi / 2 * k / kSteps);
      corners.emplace_back(from + ends.lead_length * Eigen::Vector2d(turn.sin, 1 - turn.cos));
    }
  }
  std::vector<Eigen::Vector2d> way;
  for (size_t i = 0; i + 1 < corners.size(); ++i) {
    const double length = (corners[i + 1] - corners[i]).norm();
    const int steps = std::max(1, static_cast<int>(std::ceil(length / spacing - 1e-9)));
    for (int k = 1; k <= steps; ++k) way.push_back(corners[i] + (corners[i + 1] - corners[i]) * k / steps);
  }
  return way;
}

// Points of one end, from the pass outwards. `outwards` is +1 at the last point, -1 at the first.
std::vector<MillingPoint> Lead(const MillingPoint& end, const std::vector<Eigen::Vector2d>& way,
                               double outwards, PointKind kind) {
  std::vector<MillingPoint> points;
  for (const Eigen::Vector2d& place : way) {
    MillingPoint point = end;
    point.kind = kind;
    point.position += outwards * place.x() * end.feed + place.y() * end.normal;
    points.push_back(point);
  }
  return points;
}

void CountArcLength(Pass& pass) {
  pass.points[0].arc_length = 0;
  for (size_t i = 1; i < pass.points.size(); ++i)
    pass.points[i].arc_length =
        pass.points[i - 1].arc_length + (pass.points[i].position - pass.points[i - 1].position).norm();
}

// Whatever there is of `points` at arc length s from their first, raised by `height` along the normal and run
// through forwards or back.
MillingPoint Raised(const std::vector<MillingPoint>& points, const std::vector<double>& arcs, double s,
                    double height, bool forwards) {
  const size_t next = std::clamp<size_t>(
      static_cast<size_t>(std::ranges::upper_bound(arcs, s) - arcs.begin()), 1, points.size() - 1);
  const double length = arcs[next] - arcs[next - 1], share = length > 0 ? (s - arcs[next - 1]) / length : 0;
  const MillingPoint &a = points[next - 1], &b = points[next];
  MillingPoint point = share < 0.5 ? a : b;
  const auto between = [share](const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
    return Eigen::Vector3d((1 - share) * u + share * v);
  };
  point.normal = between(a.normal, b.normal).normalized();
  point.tool_axis = between(a.tool_axis, b.tool_axis).normalized();
  point.feed = between(a.feed, b.feed);
  point.feed = (point.feed - point.feed.dot(point.normal) * point.normal).normalized();
  if (!forwards) point.feed = -point.feed;
  point.position = between(a.position, b.position) + height * point.normal;
  point.kind = PointKind::kLeadIn;
  return point;
}

// From `height` above the first point down to it, to and fro along the points.
std::vector<MillingPoint> AlongIn(const std::vector<MillingPoint>& points, const PassEnds& ends) {
  std::vector<double> arcs{0};
  for (size_t i = 1; i < points.size(); ++i)
    arcs.push_back(arcs.back() + (points[i].position - points[i - 1].position).norm());
  const double whole = arcs.back();
  const SineCosine ramp = SinCos(ends.ramp_angle);
  const double slope = ramp.sin / ramp.cos, run = ends.lead_length / slope;
  // What is left to run, at every point of the pass that is met on the way.
  std::vector<double> left{run};
  for (int leg = static_cast<int>(std::floor(run / whole)); leg >= 0; --leg)
    for (size_t i = arcs.size(); i-- > 0;) {
      const double at = leg * whole + (leg % 2 == 0 ? arcs[i] : whole - arcs[arcs.size() - 1 - i]);
      if (at > 0 && at < left.back() - 1e-9) left.push_back(at);
    }
  std::vector<MillingPoint> way;
  for (const double d : left) {
    const int leg = static_cast<int>(std::floor(d / whole - 1e-12));
    const double on = d - leg * whole;
    way.push_back(Raised(points, arcs, leg % 2 == 0 ? on : whole - on, d * slope, leg % 2 != 0));
  }
  return way;
}

// Goes round to the start and on over it by at least `overlap` (mm).
void Open(double overlap, Pass& pass) {
  const size_t count = pass.points.size();
  const double round =
      pass.points.back().arc_length + (pass.points.front().position - pass.points.back().position).norm();
  for (size_t i = 0; i < count; ++i) {
    MillingPoint again = pass.points[i];
    again.arc_length += round;
    pass.points.push_back(again);
    if (pass.points[i].arc_length >= overlap - 1e-9) break;
  }
  pass.closed = false;
}

}  // namespace

namespace {

void AddAlong(const PassEnds& ends, double spacing, double least, Toolpath& toolpath) {
  PassEnds straight = ends, up = ends;
  straight.lead = LeadShape::kNone;
  up.lead = LeadShape::kNormal;
  const std::vector<Eigen::Vector2d> before = LeadWay(straight, spacing);
  for (size_t i = 0; i < toolpath.passes.size(); ++i) {
    Pass& pass = toolpath.passes[i];
    if (pass.points.empty()) continue;
    up.overrun = pass.closed ? 0 : ends.overrun;
    if (pass.closed) Open(ends.overrun, pass);
    pass.opening = RingOpening::kNone;
    pass.reversible = false;
    const std::vector<MillingPoint> out =
        Lead(pass.points.back(), LeadWay(up, spacing), 1, PointKind::kLeadOut);
    if (up.overrun > 0) {
      std::vector<MillingPoint> first = Lead(pass.points.front(), before, -1, PointKind::kLeadIn);
      std::ranges::reverse(first);
      pass.points.insert(pass.points.begin(), first.begin(), first.end());
    }
    CountArcLength(pass);
    const double length = pass.points.back().arc_length;
    if (pass.points.size() < 2 || length < least)
      throw InputError(
          {}, fmt::format("toolpath.ends.lead: along needs passes of at least the cutter's diameter, "
                          "{:.6g} mm, or a core would be left standing; pass {} is {:.3f} mm long: "
                          "give overrun_mm, another region, or a cutter with centre_cutting",
                          least, i, length));
    std::vector<MillingPoint> in = AlongIn(pass.points, ends);
    in.insert(in.end(), pass.points.begin(), pass.points.end());
    in.insert(in.end(), out.begin(), out.end());
    pass.points = std::move(in);
    CountArcLength(pass);
  }
}

}  // namespace

void AddPassEnds(const PassEnds& ends, double spacing, Toolpath& toolpath, double least_along) {
  if (ends.lead == LeadShape::kAlong) return AddAlong(ends, spacing, least_along, toolpath);
  const std::vector<Eigen::Vector2d> way = LeadWay(ends, spacing);
  PassEnds after_overlap = ends;
  after_overlap.overrun = 0;
  const std::vector<Eigen::Vector2d> closed_way = LeadWay(after_overlap, spacing);
  if (way.empty()) return;
  for (Pass& pass : toolpath.passes) {
    if (pass.points.empty() || (pass.closed && ends.lead == LeadShape::kNone)) continue;
    if (pass.closed && pass.opening != RingOpening::kNone) continue;  // the planner opens it and adds leads
    const std::vector<Eigen::Vector2d>& own = pass.closed ? closed_way : way;
    if (pass.closed) Open(ends.overrun, pass);
    std::vector<MillingPoint> in = Lead(pass.points.front(), own, -1, PointKind::kLeadIn);
    const std::vector<MillingPoint> out = Lead(pass.points.back(), own, 1, PointKind::kLeadOut);
    std::ranges::reverse(in);
    in.insert(in.end(), pass.points.begin(), pass.points.end());
    in.insert(in.end(), out.begin(), out.end());
    pass.points = std::move(in);
    CountArcLength(pass);
  }
}

std::vector<double> LayerOffsets(const Layers& layers) {
  const double last = std::min(layers.finishing, layers.total), roughing = layers.total - last;
  const int count = last > 0 && roughing <= 0
                        ? 0
                        : std::max(1, static_cast<int>(std::ceil(roughing / layers.per_layer - 1e-9)));
  std::vector<double> offsets;
  for (int layer = 1; layer <= count; ++layer)
    offsets.push_back(layers.allowance + last + roughing * (count - layer) / count);
  if (last > 0) offsets.push_back(layers.allowance);
  return offsets;
}

Toolpath Layered(const Toolpath& toolpath, const Layers& layers) {
  Toolpath layered;
  layered.notes = toolpath.notes;
  for (const double offset : LayerOffsets(layers))
    for (const Pass& pass : toolpath.passes) {
      Pass& added = layered.passes.emplace_back(pass);
      for (MillingPoint& point : added.points) point.position += offset * point.normal;
    }
  return layered;
}

}  // namespace millpose
