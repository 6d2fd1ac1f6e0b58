// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/drill_holes.hpp"

#include <algorithm>
#include <map>

#include "base/error.hpp"
#include "base/trig.hpp"
#include "geometry/mesh/round_holes.hpp"
#include "geometry/mesh/triangle.hpp"
#include "toolpath/lost_faces.hpp"

namespace millpose {
namespace {

// How far the tip lies under the end of the full diameter.
double TipLength(const Drill& drill, double radius) {
  if (drill.point_angle >= kPi) return 0;
  const SineCosine half = SinCos(drill.point_angle / 2);
  return radius * half.cos / half.sin;
}

// Depth of the tip, where it does not depend on the hole.
double SinkDepth(const Drill& drill) {
  return drill.countersink->depth ? *drill.countersink->depth
                                  : TipLength(drill, *drill.countersink->diameter / 2);
}

// Where a line along the axis meets the part, as heights over the entrance; `leaves`: faces that look away.
std::vector<double> Met(const Mesh& mesh, const std::vector<int>& faces, const Eigen::Vector3d& through,
                        const DrilledHole& hole, bool leaves) {
  constexpr double kLeast = 0.5;  // cosine: steeper faces are walls beside the hole
  std::vector<double> heights;
  for (const int face : faces) {
    const double slope = mesh.FaceNormal(face).dot(hole.axis);
    if (leaves ? slope > -kLeast : slope < kLeast) continue;
    const Eigen::Vector3d& a = mesh.Corner(face, 0);
    const double way = mesh.FaceNormal(face).dot(a - through) / slope;
    const Eigen::Vector3d below = through + (way - 1) * hole.axis;  // the ray starts 1 mm under the face
    if (RayCrosses(below, hole.axis, a, mesh.Corner(face, 1), mesh.Corner(face, 2)))
      heights.push_back((through + way * hole.axis - hole.entrance).dot(hole.axis));
  }
  return heights;
}

// Finds how high and how deep the part's own surface stands round a hole, by lines at the cutter's rim.
void LookRound(const Mesh& mesh, double radius, DrilledHole& hole) {
  constexpr int kLines = 24;
  if (mesh.face_count() == 0) return;
  const Eigen::Vector3d u = hole.axis.unitOrthogonal(), v = hole.axis.cross(u);
  const Eigen::Vector3d middle = hole.entrance - hole.depth / 2 * hole.axis;
  const std::vector<int> along = mesh.FacesNear(middle, hole.depth / 2 + 2 * radius);
  double lowest_out = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kLines; ++i) {
    const SineCosine at = SinCos(2 * kPi * i / kLines);
    const double off = i == kLines ? 0 : radius;
    const Eigen::Vector3d through = hole.entrance + off * (at.cos * u + at.sin * v);
    for (const double height : Met(mesh, along, through, hole, false))
      if (height < 2 * radius && height > -2 * radius) hole.top = std::max(hole.top, height);
    double first = -std::numeric_limits<double>::infinity();  // the far side that comes first on the way down
    for (const double height : Met(mesh, along, through, hole, true))
      if (height < -1e-6) first = std::max(first, height);
    if (std::isfinite(first)) lowest_out = std::min(lowest_out, first);
  }
  if (std::isfinite(lowest_out)) hole.out = std::max(hole.out, lowest_out);
}

std::vector<DrilledHole> Given(const Drill& drill, double radius, std::vector<Problem>& problems) {
  std::vector<DrilledHole> drilled;
  for (size_t i = 0; i < drill.holes.size(); ++i) {
    const HolePlace& place = drill.holes[i];
    DrilledHole& hole = drilled.emplace_back();
    hole.entrance = place.entrance;
    hole.axis = place.axis;
    const std::optional<double> depth = place.depth ? place.depth : drill.depth;
    if (std::abs(place.axis.norm() - 1) >= 1e-9)
      problems.push_back({{},
                          fmt::format("toolpath.drill.holes[{}].axis: its length must be 1, given {}", i,
                                      place.axis.norm())});
    if (drill.countersink) {
      hole.depth = SinkDepth(drill);
    } else if (depth) {
      hole.depth = *depth + TipLength(drill, radius);
    } else {
      problems.push_back({{}, fmt::format("toolpath.drill.holes[{}]: no depth is given", i)});
    }
  }
  return drilled;
}

// Whether a hole's wall, or the surface that it opens in, lies in the region.
bool IsIn(const Region& region, const RoundHole& hole) {
  const auto holds = [&](int face) {
    return face >= 0 && region.HasFace(face) && region.Margin(face, hole.entrance) >= 0;
  };
  return std::ranges::any_of(hole.faces, [&](int face) {
    bool in = holds(face);
    for (int k = 0; k < 3; ++k) in = in || holds(region.mesh().Neighbour(face, k));
    return in;
  });
}

std::string DiametersText(const std::vector<RoundHole>& holes) {
  std::map<std::string, size_t> counts;
  for (const RoundHole& hole : holes) ++counts[fmt::format("{:.3f}", hole.diameter)];
  std::vector<std::string> texts;
  for (const auto& [diameter, count] : counts) texts.push_back(fmt::format("{} of {}", count, diameter));
  return texts.empty() ? "none" : fmt::format("{} mm", fmt::join(texts, ", "));
}

// A hole of the part turned to the side that it is drilled from.
void Turn(const CircleChoice& circles, RoundHole& hole, std::vector<Problem>& problems) {
  const Eigen::Vector3d& p = hole.entrance;
  const auto told = [&](const char* what) {
    problems.push_back(
        {{},
         fmt::format("toolpath.drill.circles.from: {}; the hole of {:.3f} mm at ({:.3f}, "
                     "{:.3f}, {:.3f}) mm in the workpiece frame {}",
                     circles.from ? "given" : "missing", hole.diameter, p.x(), p.y(), p.z(), what)});
  };
  if (hole.kind == HoleKind::kThrough && !circles.from) {
    told("has two ends: say from which side the tool comes");
  } else if (hole.kind == HoleKind::kThrough) {
    const double side = hole.axis.dot(*circles.from);
    if (std::abs(side) < 0.1) told("runs across that direction, so its side is not certain");
    if (side >= 0) return;
    hole.entrance -= hole.depth * hole.axis;
    hole.axis = -hole.axis;
  } else if (circles.from && hole.axis.dot(*circles.from) <= 0) {
    told("opens to the other side");
  }
}

std::vector<DrilledHole> Found(const Drill& drill, const StrategyInputs& inputs,
                               std::vector<Problem>& problems) {
  const CircleChoice& circles = *drill.circles;
  const double radius = inputs.options.cutter.radius;
  RefuseLostFaces(inputs.mesh, inputs.options.region);
  const Region region(inputs.mesh, inputs.options.region);
  std::vector<RoundHole> all = FindRoundHoles(inputs.mesh, inputs.options.crease, circles.tolerance);
  std::erase_if(all, [&](const RoundHole& hole) { return !IsIn(region, hole); });
  std::vector<DrilledHole> drilled;
  for (RoundHole& found : all) {
    if (std::abs(found.diameter - circles.diameter) > circles.tolerance) continue;
    Turn(circles, found, problems);
    DrilledHole& hole = drilled.emplace_back();
    hole.entrance = found.entrance;
    hole.axis = found.axis;
    const bool rim = found.kind == HoleKind::kRim, through = found.kind == HoleKind::kThrough;
    if (through) hole.out = -found.depth;
    if (drill.countersink) {
      hole.depth = SinkDepth(drill);
    } else if (drill.depth) {
      hole.depth = *drill.depth + TipLength(drill, radius);
    } else if (rim) {
      problems.push_back({{},
                          "toolpath.drill.depth_mm: missing; the part is a sheet, which does not say how "
                          "deep its holes are"});
      break;
    } else if (through && !drill.breakthrough) {
      problems.push_back({{}, "toolpath.drill.breakthrough_mm: missing; required where holes go through"});
      break;
    } else {
      hole.depth = found.depth + (through ? *drill.breakthrough : 0) + TipLength(drill, radius);
    }
  }
  if (drilled.empty())
    problems.push_back({{},
                        fmt::format("toolpath.drill.circles.diameter_mm: given {:.6g}; round holes in the "
                                    "region: {}",
                                    circles.diameter, DiametersText(all))});
  return drilled;
}

void CheckCutter(const Drill& drill, double diameter, std::vector<Problem>& problems,
                 std::vector<std::string>& warnings) {
  if (!(diameter > 0)) problems.push_back({{}, "toolpath: a drill needs a cutter"});
  if (!drill.circles || drill.countersink) return;
  const double wanted = drill.circles->diameter, tolerance = drill.circles->tolerance;
  const std::string text = fmt::format(
      "toolpath.drill.circles.diameter_mm: given {:.6g}, the cell's cutter has {:.6g} mm", wanted, diameter);
  if (diameter > wanted + tolerance) problems.push_back({{}, text + ": it would drill them too large"});
  if (diameter < wanted - tolerance) warnings.push_back(text + ": the holes are drilled smaller");
}

}  // namespace

std::vector<DrilledHole> HolesOf(const Drill& drill, const StrategyInputs& inputs,
                                 std::vector<std::string>& warnings) {
  std::vector<Problem> problems;
  const double radius = inputs.options.cutter.radius;
  CheckCutter(drill, 2 * radius, problems, warnings);
  if (!(drill.clearance > 0))
    problems.push_back(
        {{}, fmt::format("toolpath.drill.clearance_mm: must be above 0, given {}", drill.clearance)});
  if (!(drill.point_angle > 0 && drill.point_angle <= kPi))
    problems.push_back({{}, "toolpath.drill.point_deg: must be above 0 and at most 180"});
  if (drill.circles && inputs.mesh.face_count() == 0)
    problems.push_back({{}, "toolpath.drill.circles: needs a part; none is given"});
  if (!problems.empty()) throw InputError(std::move(problems));
  std::vector<DrilledHole> holes =
      drill.circles ? Found(drill, inputs, problems) : Given(drill, radius, problems);
  if (holes.empty() && problems.empty()) problems.push_back({{}, "toolpath.drill: no hole is given"});
  if (!problems.empty()) throw InputError(std::move(problems));
  for (DrilledHole& hole : holes) LookRound(inputs.mesh, radius, hole);
  return holes;
}

std::vector<size_t> ShortWay(const std::vector<Eigen::Vector3d>& places) {
  constexpr int kMostRounds = 50;
  const size_t count = places.size();
  std::vector<size_t> laid(count);
  for (size_t i = 0; i < count; ++i) laid[i] = i;
  const auto between = [&](size_t a, size_t b) { return (places[a] - places[b]).norm(); };
  const auto length = [&](const std::vector<size_t>& order) {
    double sum = 0;
    for (size_t i = 1; i < count; ++i) sum += between(order[i - 1], order[i]);
    return sum;
  };
  std::vector<size_t> order = laid;
  for (size_t i = 1; i < count; ++i) {
    size_t nearest = i;
    for (size_t k = i + 1; k < count; ++k)
      if (between(order[i - 1], order[k]) < between(order[i - 1], order[nearest])) nearest = k;
    std::swap(order[i], order[nearest]);
  }
  bool shorter = true;
  for (int round = 0; shorter && round < kMostRounds; ++round) {
    shorter = false;
    for (size_t i = 1; i < count; ++i)
      for (size_t k = i + 1; k < count; ++k) {  // i..k turned round; the way behind k may be none
        const double behind =
            k + 1 < count ? between(order[i], order[k + 1]) - between(order[k], order[k + 1]) : 0;
        if (between(order[i - 1], order[k]) - between(order[i - 1], order[i]) + behind > -1e-9) continue;
        std::reverse(order.begin() + static_cast<std::ptrdiff_t>(i),
                     order.begin() + static_cast<std::ptrdiff_t>(k) + 1);
        shorter = true;
      }
  }
  return length(order) < length(laid) ? order : laid;
}

}  // namespace millpose
