// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/make_toolpath.hpp"

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/rotation.hpp"
#include "toolpath/lost_faces.hpp"
#include "toolpath/resample.hpp"
#include "toolpath/strategy.hpp"
#include "toolpath/track.hpp"

namespace millpose {
namespace {

void CheckOptions(const ToolpathOptions& options) {
  std::vector<Problem> problems;
  const auto require = [&](bool holds, std::string_view rule, double given) {
    if (!holds) problems.push_back({{}, fmt::format("toolpath: {}, given {}", rule, given)});
  };
  require(options.stepover > 0 || options.strategy->IsPrescribed(), "the step-over must be above 0 mm",
          options.stepover);
  require(options.chord_tolerance > 0, "the chord tolerance must be above 0 mm", options.chord_tolerance);
  require(options.spacing > 0, "the spacing must be above 0 mm", options.spacing);
  require(options.region.rim_distance >= 0, "the rim distance must not be negative (mm)",
          options.region.rim_distance);
  require(options.scallop >= 0, "the scallop height must not be negative (mm)", options.scallop);
  require(options.scallop == 0 || options.cutter.radius > 0,
          "a scallop height needs a cutter; its radius must be above 0 mm", options.cutter.radius);
  const bool ball = options.cutter.radius > 0 && options.cutter.corner_radius == options.cutter.radius;
  require(
      options.scallop == 0 || options.tool_axis.rule == AxisRule::kNormal || ball,
      "a scallop height with another tool_axis than the normal needs a ball cutter; its corner radius (mm) "
      "must be its radius",
      options.cutter.corner_radius);
  require(options.normal_smoothing >= 0, "the length of smoothing must not be negative (mm)",
          options.normal_smoothing);
  require(options.layers.finishing >= 0, "the depth of the last layer must not be negative (mm)",
          options.layers.finishing);
  require(options.layers.total >= 0, "the depth must not be negative (mm)", options.layers.total);
  require(options.layers.per_layer > 0, "the depth of a layer must be above 0 mm", options.layers.per_layer);
  if (options.share) {
    require(std::abs(options.share->direction.norm() - 1) < 1e-9, "the share's direction must have length 1",
            options.share->direction.norm());
    require(options.share->from < options.share->to, "the share must go from less to more, mm between them",
            options.share->to - options.share->from);
    require(options.share->overlap >= 0, "the share's overlap must not be negative (mm)",
            options.share->overlap);
  }
  if (!problems.empty()) throw InputError(std::move(problems));
}

// The direction of travel at an end of a piece, from there along the curve (`step` 1) or up to there (−1):
// that of the next piece which is long enough to have one. Zero where the curve ends.
Eigen::Vector3d Beside(const Curve& curve, int piece, int step, double least_length) {
  const int count = static_cast<int>(curve.pieces.size());
  for (int i = 0; i < count; ++i, piece += step) {
    if (curve.closed) piece = (piece + count) % count;
    if (piece < 0 || piece >= count) break;
    if (curve.pieces[piece].LengthBound(0, 1) > least_length)
      return curve.pieces[piece].Direction(step > 0 ? 0 : 1);
  }
  return Eigen::Vector3d::Zero();
}

// The direction of travel; where a piece ends and the next begins it lies between both.
Eigen::Vector3d Travel(const Curve& curve, const CurvePoint& at, double least_length) {
  const CurvePiece& piece = curve.pieces[at.piece];
  if (at.t > 0 && at.t < 1 && piece.LengthBound(0, 1) > least_length) return piece.Direction(at.t);
  const Eigen::Vector3d before = Beside(curve, at.t > 0 ? at.piece : at.piece - 1, -1, least_length);
  const Eigen::Vector3d after = Beside(curve, at.t < 1 ? at.piece : at.piece + 1, 1, least_length);
  const Eigen::Vector3d sum = before + after;
  return sum.norm() > 1e-6 ? Eigen::Vector3d(sum.normalized()) : piece.Direction(at.t);
}

class PassMaker {
 public:
  /// `normal`: of all points, where the region is plane.
  PassMaker(const Mesh& mesh, const ToolpathOptions& options, const CornerNormals& normals,
            const std::optional<Eigen::Vector3d>& normal)
      : mesh_(mesh), options_(options), normals_(normals), normal_(normal) {}

  Pass Make(const Curve& curve) const {
    Pass pass;
    pass.closed = curve.closed;
    pass.rotation_reference = options_.rotation_reference;
    for (const CurvePoint& at : Resample(curve, options_.chord_tolerance, options_.spacing, options_.parts))
      pass.points.push_back(Point(curve, at));
    return pass;
  }

 private:
  MillingPoint Point(const Curve& curve, const CurvePoint& at) const {
    const CurvePiece& piece = curve.pieces[at.piece];
    MillingPoint point;
    point.position = piece.At(at.t);
    point.normal = normal_ ? *normal_ : NormalOn(mesh_, normals_, piece, point.position);
    const Eigen::Vector3d travel = Travel(curve, at, options_.chord_tolerance);
    point.feed = (travel - travel.dot(point.normal) * point.normal).normalized();
    SetAxis(point);
    point.feed_rate = options_.feed_rate;
    point.arc_length = at.arc_length;
    return point;
  }

  // The tool axis: as the rule has it, leaning by lead and tilt.
  void SetAxis(MillingPoint& point) const {
    const SineCosine lead = SinCos(options_.lead);
    if (options_.tool_axis.rule == AxisRule::kNormal) {
      const Eigen::Vector3d leaning = lead.cos * point.normal + lead.sin * point.feed;
      point.tool_axis = RotationAbout(point.feed, options_.tilt) * leaning;
      return;
    }
    const Eigen::Vector3d axis = ToolAxisAt(options_.tool_axis, point.position, point.normal);
    point.tool_axis = axis;
    const Eigen::Vector3d ahead =
        point.feed - point.feed.dot(axis) * axis;  // what leads in the plane across it
    if ((options_.lead != 0 || options_.tilt != 0) && ahead.norm() > 1e-6) {
      const Eigen::Vector3d leaning = lead.cos * axis + lead.sin * ahead.normalized();
      point.tool_axis = RotationAbout(ahead.normalized(), options_.tilt) * leaning;
    }
    // From under the surface no cutter touches it.
    constexpr double kBelow = -0.01;  // cosine: 0.6° beyond the wall's own direction
    if (point.tool_axis.dot(point.normal) < kBelow) point.gouge = options_.cutter.length;
  }

  const Mesh& mesh_;
  const ToolpathOptions& options_;
  const CornerNormals& normals_;
  std::optional<Eigen::Vector3d> normal_;
};

// A part of a curve to be milled without lifting the tool.
struct Cut {
  Curve curve;
  bool reversible = false;  ///< may be milled from either end
  RingOpening opening = RingOpening::kNone;
};

// Whether unmilled material lies on the right of the way, seen against the normal.
bool IsClimb(const Mesh& mesh, const CurveGroup& lane, const Curve& curve) {
  constexpr double kAside = 0.01;  // mm
  double sum = 0;
  for (const CurvePiece& piece : curve.pieces) {
    const Eigen::Vector3d right = kAside * piece.Direction(0.5).cross(mesh.FaceNormal(piece.face));
    const Eigen::Vector3d p = piece.At(0.5);
    sum += piece.LengthBound(0, 1) * (lane.advance(p + right) - lane.advance(p - right));
  }
  return sum > 0;
}

std::vector<Curve> Shared(const std::vector<Curve>& curves, const ToolpathOptions& options) {
  std::vector<Curve> parts;
  for (const Curve& curve : curves)
    std::ranges::move(ClipToSection(curve, *options.share, options.chord_tolerance),
                      std::back_inserter(parts));
  return parts;
}

// The parts of a lane that lie in the region and its share, in the order and direction of milling.
std::vector<Cut> CutsOf(const CurveGroup& lane, const Region& region, const CornerNormals& normals,
                        const ToolpathOptions& options) {
  const Mesh& mesh = region.mesh();
  std::vector<Curve> parts;
  for (const Curve& curve : lane.curves) {
    if (lane.clipped) {
      parts.push_back(curve);
      continue;
    }
    for (Curve& part : ClipToRegion(mesh, curve, region, normals, options.crease, options.chord_tolerance))
      parts.push_back(std::move(part));
  }
  if (options.share) parts = Shared(parts, options);
  std::vector<std::pair<double, size_t>> order;
  for (size_t i = 0; i < parts.size(); ++i)
    order.emplace_back(lane.progress ? lane.progress(parts[i].pieces.front().start) : 0.0, i);
  std::ranges::sort(order);
  const bool zigzag = options.direction == Direction::kZigzag, backwards = zigzag && lane.backwards;
  const bool sided = !lane.oriented && (options.direction == Direction::kClimb ||
                                        options.direction == Direction::kConventional);
  if (sided && !lane.advance && !parts.empty())
    throw InputError({}, fmt::format("toolpath: direction climb or conventional needs passes side by side; "
                                     "strategy {} has none",
                                     options.strategy->Name()));
  if (backwards) std::ranges::reverse(order);
  std::vector<Cut> cuts;
  for (const auto& [progress, i] : order) {
    const Curve& part = parts[i];
    const bool turned = sided ? IsClimb(mesh, lane, part) != (options.direction == Direction::kClimb)
                              : backwards && !part.closed;
    cuts.push_back({turned ? Reversed(part) : part, zigzag && !part.closed,
                    part.closed ? lane.opening : RingOpening::kNone});
  }
  return cuts;
}

double TravelLength(const std::vector<Cut>& cuts) {
  double length = 0;
  for (size_t i = 1; i < cuts.size(); ++i)
    length += (cuts[i].curve.pieces.front().start - cuts[i - 1].curve.pieces.back().end).norm();
  return length;
}

// From the first on always the nearest one, from its nearer end where it may be turned; as it was when that
// is no shorter.
std::vector<Cut> OrderedByTravel(std::vector<Cut> cuts) {
  std::vector<Cut> ordered;
  std::vector<char> used(cuts.size(), 0);
  for (size_t next = 0, turn = 0; ordered.size() < cuts.size();) {
    used[next] = 1;
    ordered.push_back({turn != 0 ? Reversed(cuts[next].curve) : cuts[next].curve, cuts[next].reversible,
                       cuts[next].opening});
    const Eigen::Vector3d& end = ordered.back().curve.pieces.back().end;
    double best = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < cuts.size(); ++i) {
      if (used[i] != 0) continue;
      const double ahead = (cuts[i].curve.pieces.front().start - end).norm();
      const double behind = (cuts[i].curve.pieces.back().end - end).norm();
      if (ahead < best) best = ahead, next = i, turn = 0;
      if (cuts[i].reversible && behind < best) best = behind, next = i, turn = 1;
    }
  }
  return TravelLength(ordered) < TravelLength(cuts) ? ordered : cuts;
}

void MoveToTip(const CutterShape& cutter, Toolpath& toolpath) {
  for (Pass& pass : toolpath.passes)
    for (MillingPoint& point : pass.points)
      point.position = TipAtContact(cutter, point.position, point.normal, point.tool_axis);
}

void TellWhatIsBelow(Toolpath& toolpath) {
  size_t below = 0;
  for (const Pass& pass : toolpath.passes)
    below += static_cast<size_t>(
        std::ranges::count_if(pass.points, [](const MillingPoint& point) { return point.gouge > 0; }));
  if (below > 0)
    toolpath.notes.push_back(
        fmt::format("at {} points tool_axis would have the tool come from under the "
                    "surface; they are skipped",
                    below));
}

// What is laid by distances from borders: neighbouring passes are a step-over apart everywhere.
void CheckArea(const Region& region, const ToolpathOptions& options) {
  double area = 0;
  for (const Region::Patch& patch : region.Patches()) area += AreaInside(region, patch);
  CheckBudget(options, {std::sqrt(area) / options.stepover, area / options.stepover});
}

// Parts of all lanes, in the order of milling. Throws InputError where there are none.
std::vector<Cut> AllCuts(const Layout& layout, const Region& region, const CornerNormals& normals,
                         const ToolpathOptions& options, const std::stop_token& stop) {
  std::vector<Cut> cuts;
  for (const CurveGroup& lane : layout.lanes) {
    CheckStop(stop);
    std::ranges::move(CutsOf(lane, region, normals, options), std::back_inserter(cuts));
  }
  if (cuts.empty() && options.share) {
    ToolpathOptions whole = options;
    whole.share.reset();
    const std::vector<Cut> all = AllCuts(layout, region, normals, whole, stop);
    std::pair<double, double> extent = ExtentOf(all.front().curve, options.share->direction);
    for (const Cut& cut : all) {
      const auto [least, most] = ExtentOf(cut.curve, options.share->direction);
      extent = {std::min(extent.first, least), std::max(extent.second, most)};
    }
    throw InputError({},
                     fmt::format("toolpath.share: nothing of the tool path lies in it; along its direction "
                                 "the path goes from {:.3f} to {:.3f} mm",
                                 extent.first, extent.second));
  }
  if (cuts.empty()) {
    const double kept = options.region.rim_distance;
    const std::string from_border =
        kept > 0 ? fmt::format(
                       " at least {:.6g} mm from its border (region.rim_distance_mm; of a pad offset_mm, "
                       "by default the cutter's radius)",
                       kept)
                 : "";
    throw InputError({}, fmt::format("toolpath: nothing of the mesh lies in the region{}; check the region's "
                                     "conditions and the mesh's unit and orientation",
                                     from_border));
  }
  return cuts;
}

Toolpath LayPasses(const SurfaceStrategy& strategy, const Mesh& mesh, ToolpathOptions options,
                   const std::stop_token& stop) {
  CheckOptions(options);
  options.region.rim_distance = strategy.RimDistance(options);
  const Region region(mesh, options.region);
  RefuseLostFaces(mesh, options.region);
  if (strategy.IsLaidFromBorders()) CheckArea(region, options);
  const CornerNormals normals(mesh, options.crease, options.normal_smoothing);
  Layout layout = strategy.Lay(region, options, stop);
  std::vector<Cut> cuts = AllCuts(layout, region, normals, options, stop);
  PathCount count{static_cast<double>(cuts.size()), 0};
  for (const Cut& cut : cuts)
    for (const CurvePiece& piece : cut.curve.pieces) {
      const Eigen::Vector3d middle = piece.At(0.5);
      count.way += (middle - piece.start).norm() + (piece.end - middle).norm();
    }
  CheckBudget(options, count);
  if (options.order_by_travel) cuts = OrderedByTravel(std::move(cuts));
  Toolpath toolpath;
  toolpath.notes = std::move(layout.notes);
  const PassMaker maker(mesh, options, normals, layout.normal);
  for (const Cut& cut : cuts) {
    toolpath.passes.push_back(maker.Make(cut.curve));
    toolpath.passes.back().opening = cut.opening;
    toolpath.passes.back().reversible = cut.reversible;
    count.covered += static_cast<double>(toolpath.passes.back().points.size());
    CheckBudget(options, count);
  }
  toolpath = Layered(toolpath, options.layers);
  TellWhatIsBelow(toolpath);
  const bool upright = options.tool_axis.rule == AxisRule::kNormal && options.lead == 0 && options.tilt == 0;
  if (!upright) MoveToTip(options.cutter, toolpath);
  AddPassEnds(options.ends, options.spacing, toolpath,
              options.centre_cutting ? 0 : 2 * options.cutter.radius);
  return toolpath;
}

}  // namespace

LaidPath SurfaceStrategy::Make(const StrategyInputs& inputs, std::stop_token stop) const {
  LaidPath laid;
  laid.toolpath = LayPasses(*this, inputs.mesh, inputs.options, stop);
  for (const std::string& note : laid.toolpath.notes) laid.warnings.push_back("toolpath: " + note);
  return laid;
}

void RequireUnit(const Eigen::Vector3d& direction, std::string_view what) {
  if (std::abs(direction.norm() - 1) >= 1e-9)
    throw InputError({}, fmt::format("toolpath: {} must have length 1, given {}", what, direction.norm()));
}

Toolpath MakeToolpath(const Mesh& mesh, const ToolpathOptions& options, std::stop_token stop) {
  if (!options.strategy) throw InputError({}, "toolpath: no strategy is given");
  return options.strategy->Make({mesh, options, {}}, std::move(stop)).toolpath;
}

void Transform(const Eigen::Isometry3d& X, Pass& pass) {
  pass.rotation_reference = X.linear() * pass.rotation_reference;
  for (MillingPoint& point : pass.points) {
    point.position = X * point.position;
    for (Eigen::Vector3d* direction : {&point.normal, &point.feed, &point.tool_axis, &point.engagement.force})
      *direction = X.linear() * *direction;
  }
}

Toolpath Transformed(const Toolpath& toolpath, const Eigen::Isometry3d& X) {
  Toolpath transformed = toolpath;
  for (Pass& pass : transformed.passes) Transform(X, pass);
  return transformed;
}

}  // namespace millpose
