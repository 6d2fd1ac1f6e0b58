// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/pass_ends.hpp"

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

void AddPassEnds(const PassEnds& ends, double spacing, Toolpath& toolpath) {
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
