// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/curve_strategy.hpp"

#include "surface/plane_slices.hpp"
#include "toolpath/strategy_entry.hpp"

namespace millpose {
namespace {

// A piece of the slice under one segment, with where it lies along the segment (0..1).
struct Placed {
  double from, to;
  CurvePiece piece;
};

std::vector<Placed> Under(const Mesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                          const Eigen::Vector3d& direction, const std::stop_token& stop) {
  const Eigen::Vector3d way = b - a;
  const Eigen::Vector3d flat = way - way.dot(direction) * direction;
  const Eigen::Vector3d normal = direction.cross(flat).normalized();
  std::vector<Placed> placed;
  const std::vector<Curve> slice = SliceByPlanes(mesh, normal, {normal.dot(a)}, stop)[0];
  for (const Curve& curve : slice)
    for (CurvePiece piece : curve.pieces) {
      if (piece.other_face >= 0 && mesh.FaceNormal(piece.face).dot(direction) <= 0)
        std::swap(piece.face, piece.other_face);
      if (mesh.FaceNormal(piece.face).dot(direction) <= 1e-9) continue;  // seen from the back or edge-on
      const auto along = [&](const Eigen::Vector3d& p) { return flat.dot(p - a) / flat.squaredNorm(); };
      double from = along(piece.start), to = along(piece.end);
      if (from > to) {
        piece = piece.Reversed();
        std::swap(from, to);
      }
      const double t0 = std::clamp((0 - from) / (to - from), 0.0, 1.0),
                   t1 = std::clamp((1 - from) / (to - from), 0.0, 1.0);
      if (t1 > t0) placed.push_back({from + t0 * (to - from), from + t1 * (to - from), piece.Part(t0, t1)});
    }
  std::ranges::stable_sort(placed, {}, &Placed::from);
  return placed;
}

bool Meet(const CurvePiece& before, const CurvePiece& after) {
  return (before.end - after.start).norm() < 1e-6;
}

// Several sheets may lie one above the other: a piece goes on with the curve that it touches.
void Append(const CurvePiece& piece, std::vector<Curve>& curves) {
  for (auto it = curves.rbegin(); it != curves.rend(); ++it)
    if (Meet(it->pieces.back(), piece)) {
      it->pieces.push_back(piece);
      return;
    }
  curves.emplace_back().pieces = {piece};
}

void CheckPoints(const yaml::Value& value, const yaml::Context& context, CurveStrategy& curve) {
  if (curve.points.size() < 2)
    context.Add(value.mark, fmt::format("a line needs 2 points or more, given {}", curve.points.size()));
}

}  // namespace

Layout CurveStrategy::Lay(const Region& region, const ToolpathOptions&, std::stop_token stop) const {
  RequireUnit(direction, "the curve's direction");
  std::vector<Curve> curves;
  for (size_t i = 0; i + 1 < points.size(); ++i)
    for (Placed& placed : Under(region.mesh(), points[i], points[i + 1], direction, stop))
      Append(placed.piece, curves);
  for (Curve& curve : curves)
    curve.closed = curve.pieces.size() > 2 && Meet(curve.pieces.back(), curve.pieces.front());
  // A lane each: progress must not sort what follows the user's line.
  Layout layout;
  for (Curve& curve : curves) layout.lanes.emplace_back().curves.push_back(std::move(curve));
  return layout;
}

StrategyEntry CurveEntry() {
  using S = CurveStrategy;
  using namespace yaml;
  return EntryOf<S>("curve", "Strategy curve: a single line.",
                    Section<S>({Key<S>("points_mm", MILLPOSE_AT(points), ListOf(yaml::Place()),
                                       "A polyline, in the workpiece frame.")
                                    .Required(),
                                Key<S>("direction", MILLPOSE_AT(direction), yaml::Direction(),
                                       "Along it the line is projected onto the faces that face it.")
                                    .Required()},
                               CheckPoints));
}

}  // namespace millpose
