// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/curve_strategy.hpp"

#include "base/error.hpp"
#include "geometry/slice/plane_slices.hpp"
#include "toolpath/strategies/dxf_lines.hpp"
#include "toolpath/strategy_entry.hpp"

namespace millpose {
namespace {

// A piece of the slice under one segment, with where it lies along the segment (0..1).
struct Placed {
  double from, to;
  CurvePiece piece;

  Eigen::Vector3d At(double along) const { return piece.At((along - from) / (to - from)); }
  Placed Part(double first, double last) const {
    return {first, last, piece.Part((first - from) / (to - from), (last - from) / (to - from))};
  }
};

// What of the slice under a segment lies between its ends, whichever side it shows.
std::vector<Placed> Under(const Mesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                          const Eigen::Vector3d& looking, const std::stop_token& stop) {
  const Eigen::Vector3d way = b - a;
  const Eigen::Vector3d flat = way - way.dot(looking) * looking;
  const Eigen::Vector3d normal = flat.cross(looking).normalized();
  std::vector<Placed> placed;
  const std::vector<Curve> slice = SliceByPlanes(mesh, normal, {normal.dot(a)}, stop)[0];
  for (const Curve& curve : slice)
    for (CurvePiece piece : curve.pieces) {
      if (piece.other_face >= 0 && mesh.FaceNormal(piece.face).dot(looking) >= 0)
        std::swap(piece.face, piece.other_face);
      const auto along = [&](const Eigen::Vector3d& p) { return flat.dot(p - a) / flat.squaredNorm(); };
      double from = along(piece.start), to = along(piece.end);
      if (from > to) {
        piece = piece.Reversed();
        std::swap(from, to);
      }
      const double first = std::max(from, 0.0), last = std::min(to, 1.0);
      if (last > first) placed.push_back(Placed{from, to, piece}.Part(first, last));
    }
  std::ranges::stable_sort(placed, {}, &Placed::from);
  return placed;
}

// The parts that are met first, in their order.
std::vector<Placed> Met(const std::vector<Placed>& placed, const Eigen::Vector3d& looking) {
  std::vector<double> ends;
  for (const Placed& piece : placed) ends.insert(ends.end(), {piece.from, piece.to});
  std::ranges::sort(ends);
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  std::vector<Placed> met;
  std::vector<size_t> over;  // this stretch
  size_t next = 0, last = placed.size();
  for (size_t i = 0; i + 1 < ends.size(); ++i) {
    std::erase_if(over, [&](size_t k) { return placed[k].to <= ends[i]; });
    for (; next < placed.size() && placed[next].from <= ends[i]; ++next) over.push_back(next);
    if (over.empty()) continue;
    const double middle = (ends[i] + ends[i + 1]) / 2;
    const size_t first =
        std::ranges::min(over, {}, [&](size_t k) { return looking.dot(placed[k].At(middle)); });
    if (first == last && met.back().to == ends[i]) {
      met.back() = placed[first].Part(met.back().from, ends[i + 1]);
    } else {
      met.push_back(placed[first].Part(ends[i], ends[i + 1]));
    }
    last = first;
  }
  return met;
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
  if (curve.points.empty() == !curve.dxf) context.Add(value.mark, "needs one of points_mm and dxf");
  if (!curve.dxf && curve.points.size() == 1)
    context.Add(value.mark, fmt::format("a line needs 2 points or more, given {}", curve.points.size()));
}

yaml::Codec<CurveDxf> DxfFields() {
  using S = CurveDxf;
  using namespace yaml;
  return Section<S>(
      {Key<S>("file", MILLPOSE_AT(file), Text(), "DXF as text, relative to the job file.").Required(),
       Key<S>("unit", MILLPOSE_AT(unit),
              Maybe(ChoiceOf<double>({{"mm", 1}, {"cm", 10}, {"in", 25.4}, {"m", 1000}})),
              "Unit of the file, where it states none."),
       Key<S>("layers", MILLPOSE_AT(layers), ListOf(Text()), "Only lines of these layers; all by default.")});
}

}  // namespace

LaidPath CurveStrategy::Make(const StrategyInputs& inputs, std::stop_token stop) const {
  if (!dxf) return SurfaceStrategy::Make(inputs, std::move(stop));
  DxfLines read =
      ReadDxfLines(inputs.file, dxf->file, {dxf->unit, dxf->layers, inputs.options.chord_tolerance});
  CurveStrategy drawn = *this;
  drawn.lines_ = std::move(read.lines);
  LaidPath laid = drawn.SurfaceStrategy::Make(inputs, std::move(stop));
  laid.warnings.insert(laid.warnings.end(), read.notes.begin(), read.notes.end());
  return laid;
}

Layout CurveStrategy::Lay(const Region& region, const ToolpathOptions&, std::stop_token stop) const {
  RequireUnit(project_along, "the curve's project_along");
  const Mesh& mesh = region.mesh();
  std::vector<Curve> curves;
  bool backs = false;
  const std::vector<std::vector<Eigen::Vector3d>> only{points};
  for (const std::vector<Eigen::Vector3d>& line : lines_.empty() ? only : lines_)
    for (size_t i = 0; i + 1 < line.size(); ++i)
      for (const Placed& placed :
           Met(Under(mesh, line[i], line[i + 1], project_along, stop), project_along)) {
        const bool shown = mesh.FaceNormal(placed.piece.face).dot(project_along) < -1e-9;
        backs = backs || !shown;
        if (shown) Append(placed.piece, curves);
      }
  if (curves.empty() && backs)
    throw InputError({},
                     "toolpath: looking along curve.project_along the line only meets the backs of faces; "
                     "give the opposite direction");
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
  return EntryOf<S>(
      "curve", "Strategy curve: a line, or those of a drawing.",
      Section<S>({Key<S>("points_mm", MILLPOSE_AT(points), ListOf(yaml::Coordinates()),
                         "A polyline, in the workpiece frame; or `dxf`.")
                      .WhenSet([](const S& s) { return !s.points.empty(); }),
                  Key<S>("dxf", MILLPOSE_AT(dxf), Maybe(DxfFields()),
                         "In its place the lines of a drawing, in the workpiece frame (docs/strategies.md)."),
                  Key<S>("project_along", MILLPOSE_AT(project_along), yaml::Direction(),
                         "Lines are projected along it onto the first face met.")
                      .Required()},
                 CheckPoints));
}

}  // namespace millpose
