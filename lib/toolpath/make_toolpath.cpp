// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/make_toolpath.hpp"

#include "base/error.hpp"
#include "base/parallel.hpp"
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
  require(options.stepover > 0, "the step-over must be above 0 mm", options.stepover);
  require(options.chord_tolerance > 0, "the chord tolerance must be above 0 mm", options.chord_tolerance);
  require(options.spacing > 0, "the spacing must be above 0 mm", options.spacing);
  require(options.region.rim_distance >= 0, "the rim distance must not be negative (mm)",
          options.region.rim_distance);
  require(std::abs(options.plane_normal.norm() - 1) < 1e-9, "the planes' normal must have length 1",
          options.plane_normal.norm());
  require(std::abs(options.axis_direction.norm() - 1) < 1e-9, "the rings' axis must have length 1",
          options.axis_direction.norm());
  require(std::abs(options.curve_direction.norm() - 1) < 1e-9, "the curve's direction must have length 1",
          options.curve_direction.norm());
  require(options.layers.total >= 0, "the depth must not be negative (mm)", options.layers.total);
  require(options.layers.per_layer > 0, "the depth of a layer must be above 0 mm", options.layers.per_layer);
  if (!problems.empty()) throw InputError(std::move(problems));
}

// The direction of travel where a piece ends and the next begins lies between both.
Eigen::Vector3d Travel(const Curve& curve, const CurvePoint& at) {
  const int count = static_cast<int>(curve.pieces.size());
  Eigen::Vector3d direction = curve.pieces[at.piece].Direction(at.t);
  int other = at.t >= 1 ? at.piece + 1 : at.t <= 0 ? at.piece - 1 : at.piece;
  if (curve.closed) other = (other + count) % count;
  if (other == at.piece || other < 0 || other >= count) return direction;
  const Eigen::Vector3d beside = curve.pieces[other].Direction(at.t >= 1 ? 0 : 1);
  return (direction + beside).norm() > 1e-6 ? Eigen::Vector3d((direction + beside).normalized()) : direction;
}

class PassMaker {
 public:
  PassMaker(const Mesh& mesh, const ToolpathOptions& options, const CornerNormals& normals)
      : mesh_(mesh), options_(options), normals_(normals) {}

  Pass Make(const Curve& curve) const {
    Pass pass;
    pass.closed = curve.closed;
    pass.rotation_reference = options_.rotation_reference;
    for (const CurvePoint& at : Resample(curve, options_.chord_tolerance, options_.spacing))
      pass.points.push_back(Point(curve, at));
    return pass;
  }

 private:
  MillingPoint Point(const Curve& curve, const CurvePoint& at) const {
    const CurvePiece& piece = curve.pieces[at.piece];
    MillingPoint point;
    point.position = piece.At(at.t);
    point.normal = NormalOn(mesh_, normals_, piece, point.position);
    const Eigen::Vector3d travel = Travel(curve, at);
    point.feed = (travel - travel.dot(point.normal) * point.normal).normalized();
    const Eigen::Vector3d leaning =
        std::cos(options_.lead) * point.normal + std::sin(options_.lead) * point.feed;
    point.tool_axis = Eigen::AngleAxisd(options_.tilt, point.feed) * leaning;
    point.feed_rate = options_.feed_rate;
    point.arc_length = at.arc_length;
    return point;
  }

  const Mesh& mesh_;
  const ToolpathOptions& options_;
  const CornerNormals& normals_;
};

// The parts of a lane that lie in the region, in the order and direction of milling.
std::vector<Curve> PartsOf(const Lane& lane, const Mesh& mesh, const Region& region,
                           const CornerNormals& normals, const ToolpathOptions& options) {
  std::vector<Curve> parts;
  for (const Curve& curve : lane.curves)
    for (Curve& part : ClipToRegion(mesh, curve, region, normals, options.crease, options.chord_tolerance))
      parts.push_back(std::move(part));
  std::vector<std::pair<double, size_t>> order;
  for (size_t i = 0; i < parts.size(); ++i)
    order.emplace_back(lane.progress(parts[i].pieces.front().start), i);
  std::ranges::sort(order);
  if (lane.backwards) std::ranges::reverse(order);
  std::vector<Curve> ordered;
  for (const auto& [progress, i] : order)
    ordered.push_back(lane.backwards && !parts[i].closed ? Reversed(parts[i]) : std::move(parts[i]));
  return ordered;
}

void MoveToTip(const CutterShape& cutter, Toolpath& toolpath) {
  for (Pass& pass : toolpath.passes)
    for (MillingPoint& point : pass.points)
      point.position = TipAtContact(cutter, point.position, point.normal, point.tool_axis);
}

}  // namespace

Toolpath MakeToolpath(const Mesh& mesh, const ToolpathOptions& options, std::stop_token stop) {
  CheckOptions(options);
  const std::unique_ptr<Strategy> strategy = MakeStrategy(options.strategy);
  const Region region(mesh, options.region);
  const CornerNormals normals(mesh, options.crease);
  const PassMaker maker(mesh, options, normals);
  Toolpath toolpath;
  for (const Lane& lane : strategy->Lanes(mesh, region, options, stop)) {
    CheckStop(stop);
    for (const Curve& part : PartsOf(lane, mesh, region, normals, options))
      toolpath.passes.push_back(maker.Make(part));
  }
  if (toolpath.passes.empty())
    throw InputError(
        {},
        "toolpath: nothing of the mesh lies in the region; check box, facing direction, rim distance "
        "and the mesh's unit and orientation");
  toolpath = Layered(toolpath, options.layers);
  if (options.cutter) MoveToTip(*options.cutter, toolpath);
  AddPassEnds(options.ends, options.spacing, toolpath);
  return toolpath;
}

Toolpath Transformed(const Toolpath& toolpath, const Eigen::Isometry3d& X) {
  Toolpath transformed = toolpath;
  for (Pass& pass : transformed.passes) {
    pass.rotation_reference = X.linear() * pass.rotation_reference;
    for (MillingPoint& point : pass.points) {
      point.position = X * point.position;
      for (Eigen::Vector3d* direction : {&point.normal, &point.feed, &point.tool_axis})
        *direction = X.linear() * *direction;
    }
  }
  return transformed;
}

}  // namespace millpose
