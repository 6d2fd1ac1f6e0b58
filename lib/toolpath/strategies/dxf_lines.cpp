// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/dxf_lines.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.hpp"
#include "base/shown.hpp"
#include "base/text.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "toolpath/cam/arc.hpp"
#include "toolpath/strategies/dxf_entities.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;
using DxfLine = std::vector<Vector3d>;

constexpr double kJoined = 0.01;      // mm
constexpr size_t kMostLines = 10000;  // joining looks at all pairs

/// The file's own coordinate system of an entity that lies in a plane, by its normal alone (AutoCAD's
/// arbitrary axis algorithm).
Eigen::Matrix3d PlaneOf(Vector3d normal) {
  normal.normalize();
  const bool near_z = std::abs(normal.x()) < 1.0 / 64 && std::abs(normal.y()) < 1.0 / 64;
  const Vector3d along = (near_z ? Vector3d::UnitY() : Vector3d::UnitZ()).cross(normal).normalized();
  Eigen::Matrix3d plane;
  plane << along, normal.cross(along), normal;
  return plane;
}

class EntityReader {
 public:
  EntityReader(const DxfEntity& entity, const std::string& name, double unit, double chord_tolerance)
      : entity_(entity), name_(name), unit_(unit), tolerance_(chord_tolerance) {}

  DxfLine Straight() const { return {Place(10), Place(11)}; }

  DxfLine Round(bool whole) const {
    const Eigen::Matrix3d plane = Plane();
    const Vector3d centre = plane * Place(10);
    const double radius = unit_ * Number(40);
    if (!(radius > 0)) Refuse(entity_.line, "a radius that is not above 0");
    const auto at = [&](double degrees) -> Vector3d {
      if (!(std::abs(degrees) <= 720)) Refuse(entity_.line, "an angle beyond ±720°");
      const SineCosine angle = SinCos(DegToRad(degrees));
      return centre + plane * Vector3d(radius * angle.cos, radius * angle.sin, 0);
    };
    const Vector3d from = at(whole ? 0 : Number(50)), to = whole ? from : at(Number(51));
    return Arc(from, to, centre, plane.col(2));
  }

  /// Points with bulges, the last one joined to the first where it is closed.
  DxfLine Rounded(const std::vector<Vector3d>& points, const std::vector<double>& bulges, bool closed) const {
    if (points.size() < 2) Refuse(entity_.line, "a polyline of fewer than 2 points");
    const Eigen::Matrix3d plane = Plane();
    DxfLine line{Vector3d(plane * points.front())};
    for (size_t i = 0; i + (closed ? 0 : 1) < points.size(); ++i) {
      const Vector3d& p = points[i];
      const Vector3d& q = points[(i + 1) % points.size()];
      if (p == q) continue;
      const double bulge = bulges[i];
      if (bulge == 0) {
        line.emplace_back(plane * q);
        continue;
      }
      // The bulge is the tangent of a quarter of the arc's angle, above 0 for a left turn.
      const Vector3d left(p.y() - q.y(), q.x() - p.x(), 0);
      const Vector3d centre = (p + q) / 2 + (1 - bulge * bulge) / (4 * bulge) * left;
      const DxfLine arc = Arc(plane * p, plane * q, plane * centre,
                              bulge > 0 ? Vector3d(plane.col(2)) : Vector3d(-plane.col(2)));
      line.insert(line.end(), arc.begin() + 1, arc.end());
    }
    return line;
  }

  DxfLine Light() const {
    std::vector<Vector3d> points;
    std::vector<double> bulges;
    const double height = entity_.Text(38).empty() ? 0 : unit_ * Number(38);
    for (const DxfPair& pair : entity_.pairs) {
      if (pair.code == 10) {
        points.emplace_back(unit_ * Value(pair), 0, height);
        bulges.push_back(0);
      }
      if (points.empty()) continue;
      if (pair.code == 20) points.back().y() = unit_ * Value(pair);
      if (pair.code == 42) bulges.back() = Value(pair);
    }
    return Rounded(points, bulges, (Flags() & 1) != 0);
  }

  Vector3d Place(int code) const {
    return unit_ *
           Vector3d(Number(code), Number(code + 10), entity_.Text(code + 20).empty() ? 0 : Number(code + 20));
  }
  double Bulge() const { return entity_.Text(42).empty() ? 0 : Number(42); }
  int Flags() const { return entity_.Text(70).empty() ? 0 : static_cast<int>(Number(70)); }

 private:
  [[noreturn]] void Refuse(int line, const std::string& what) const {
    throw InputError({name_, line}, fmt::format("{}: {}", entity_.kind, what));
  }
  double Value(const DxfPair& pair) const {
    const std::optional<double> number = ParseNumber(pair.value);
    if (!number || !(std::abs(*number) <= 1e9))
      Refuse(pair.line, fmt::format("code {} is {}; allowed: -1e9 to 1e9", pair.code, Shown(pair.value)));
    return *number;
  }
  double Number(int code) const {
    const auto found = std::ranges::find(entity_.pairs, code, &DxfPair::code);
    if (found == entity_.pairs.end()) Refuse(entity_.line, fmt::format("code {} is missing", code));
    return Value(*found);
  }
  Eigen::Matrix3d Plane() const {
    if (entity_.Text(210).empty()) return Eigen::Matrix3d::Identity();
    const Vector3d normal(Number(210), Number(220), Number(230));
    if (!(normal.norm() > 1e-9)) Refuse(entity_.line, "a normal (codes 210, 220, 230) without a direction");
    return PlaneOf(normal);
  }
  DxfLine Arc(const Vector3d& from, const Vector3d& to, const Vector3d& centre, const Vector3d& axis) const {
    DxfLine line{from};
    const DxfLine rest = ArcPoints(from, to, centre, axis, 0, tolerance_, {name_, entity_.line});
    line.insert(line.end(), rest.begin(), rest.end());
    return line;
  }

  const DxfEntity& entity_;
  const std::string& name_;
  double unit_, tolerance_;
};

double UnitOf(const DxfFile& file, const std::string& name, const std::optional<double>& given) {
  static const std::map<int, double> known{{1, 25.4}, {2, 304.8}, {4, 1}, {5, 10}, {6, 1000}};
  const int code = file.unit ? static_cast<int>(ParseNumber(file.unit->value).value_or(-1)) : 0;
  if (code == 0 && !given)
    throw InputError({name},
                     "the file states no unit ($INSUNITS); give toolpath.curve.dxf.unit: mm, cm, in or m");
  if (code == 0) return *given;
  const auto found = known.find(code);
  if (found == known.end())
    throw InputError({name, file.unit->line},
                     fmt::format("$INSUNITS is {}; allowed: 1 (in), 2 (foot), 4 (mm), 5 (cm), "
                                 "6 (m), or 0 and toolpath.curve.dxf.unit",
                                 Shown(file.unit->value)));
  if (given && *given != found->second)
    throw InputError(
        {name, file.unit->line},
        fmt::format("the file states that its unit is {:.6g} mm, given {:.6g} mm", found->second, *given));
  return found->second;
}

bool Touch(const Vector3d& a, const Vector3d& b) { return (a - b).norm() <= kJoined; }

// Lines whose ends meet become one, beginning with the first of the file; a closed one is left alone.
std::vector<DxfLine> Joined(std::vector<DxfLine> lines) {
  std::vector<DxfLine> joined;
  std::vector<char> used(lines.size(), 0);
  for (size_t i = 0; i < lines.size(); ++i) {
    if (used[i]) continue;
    DxfLine line = std::move(lines[i]);
    for (bool turned : {false, true}) {  // at its end, then at its beginning
      if (turned) std::ranges::reverse(line);
      for (size_t k = i + 1; k < lines.size() && !Touch(line.front(), line.back());) {
        const bool fits = !used[k] && !Touch(lines[k].front(), lines[k].back());
        if (fits && Touch(line.back(), lines[k].back())) std::ranges::reverse(lines[k]);
        if (!fits || !Touch(line.back(), lines[k].front())) {
          ++k;
          continue;
        }
        used[k] = 1;
        line.insert(line.end(), lines[k].begin() + 1, lines[k].end());
        k = i + 1;
      }
      if (turned) std::ranges::reverse(line);
    }
    joined.push_back(std::move(line));
  }
  return joined;
}

class LineReader {
 public:
  LineReader(const DxfFile& file, const std::string& name, const DxfOptions& options)
      : file_(file), name_(name), options_(options), unit_(UnitOf(file, name, options.unit)) {}

  DxfLines Run() {
    CheckLayers();
    for (size_t i = 0; i < file_.entities.size(); ++i) Add(i);
    if (lines_.size() > kMostLines)
      throw InputError({name_}, fmt::format("{} lines; allowed: {}", lines_.size(), kMostLines));
    if (lines_.empty())
      throw InputError({name_}, "the file holds no line (LINE, LWPOLYLINE, POLYLINE, ARC, CIRCLE)");
    DxfLines found{Joined(std::move(lines_)), {}};
    for (const auto& [kind, count] : left_out_)
      found.notes.push_back(fmt::format("{}: {} {} left out", name_, count, kind));
    return found;
  }

 private:
  void CheckLayers() const {
    std::vector<std::string> known;
    for (const DxfEntity& entity : file_.entities)
      if (const std::string layer(entity.Text(8)); std::ranges::find(known, layer) == known.end())
        known.push_back(layer);
    for (const std::string& layer : options_.layers)
      if (std::ranges::find(known, layer) == known.end())
        throw InputError({name_}, UnknownName("layer", layer, known));
  }

  void Add(size_t i) {
    const DxfEntity& entity = file_.entities[i];
    const std::string_view kind = entity.kind;
    if (kind == "VERTEX" || kind == "SEQEND") return;  // of the polyline before them
    if (!options_.layers.empty() &&
        std::ranges::find(options_.layers, entity.Text(8)) == options_.layers.end())
      return;
    if (entity.Text(67) == "1") return Leave("of the paper space");
    const EntityReader reader(entity, name_, unit_, options_.chord_tolerance);
    if (kind == "LINE") return Take(reader.Straight());
    if (kind == "ARC" || kind == "CIRCLE") return Take(reader.Round(kind == "CIRCLE"));
    if (kind == "LWPOLYLINE") return Take(reader.Light());
    if (kind == "POLYLINE") return Take(Heavy(i, reader));
    if (std::ranges::find(kNoCurves, kind) != std::end(kNoCurves)) return Leave(std::string(kind));
    throw InputError(
        {name_, entity.line},
        fmt::format("{} is not read; allowed: LINE, LWPOLYLINE, POLYLINE, ARC, CIRCLE; name the layers that "
                    "hold the lines (toolpath.curve.dxf.layers), or let the CAD program write polylines",
                    Shown(kind)));
  }

  DxfLine Heavy(size_t i, const EntityReader& polyline) const {
    const int flags = polyline.Flags();
    if ((flags & (16 | 64)) != 0)
      throw InputError({name_, file_.entities[i].line}, "POLYLINE: a mesh; allowed: lines");
    std::vector<Vector3d> points;
    std::vector<double> bulges;
    for (++i; i < file_.entities.size() && file_.entities[i].kind == "VERTEX"; ++i) {
      const EntityReader vertex(file_.entities[i], name_, unit_, options_.chord_tolerance);
      if ((vertex.Flags() & 16) != 0) continue;  // of a spline's frame: not on the line
      points.push_back(vertex.Place(10));
      bulges.push_back((flags & 8) != 0 ? 0 : vertex.Bulge());
    }
    return polyline.Rounded(points, bulges, (flags & 1) != 0);
  }

  void Take(DxfLine line) {
    if (line.size() > 2 || !Touch(line.front(), line.back())) return lines_.push_back(std::move(line));
    Leave("without length");
  }
  void Leave(const std::string& kind) { ++left_out_[kind]; }

  static constexpr std::string_view kNoCurves[] = {"TEXT",     "MTEXT",  "DIMENSION",   "POINT",
                                                   "HATCH",    "LEADER", "MULTILEADER", "IMAGE",
                                                   "VIEWPORT", "ATTDEF", "SOLID",       "WIPEOUT"};

  const DxfFile& file_;
  const std::string& name_;
  const DxfOptions& options_;
  double unit_;
  std::vector<DxfLine> lines_;
  std::map<std::string, int> left_out_;
};

}  // namespace

DxfLines ReadDxfLines(std::string_view bytes, const std::string& name, const DxfOptions& options) {
  const DxfFile file = ReadDxfFile(bytes, name);
  return LineReader(file, name, options).Run();
}

}  // namespace millpose
