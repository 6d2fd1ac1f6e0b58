// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/budget.hpp"

#include "base/error.hpp"
#include "toolpath/toolpath_options.hpp"

namespace millpose {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

double AreaOf(const Corners& c) { return (c[1] - c[0]).cross(c[2] - c[0]).norm() / 2; }

// The margin changes by at most 1 mm per mm: it decides alone over what lies nearer than itself.
double AreaInside(const Region& region, int face, const Corners& c, int depth) {
  const Eigen::Vector3d centre = (c[0] + c[1] + c[2]) / 3;
  const double margin = region.Margin(face, centre);
  double radius = 0;
  for (const Eigen::Vector3d& p : c) radius = std::max(radius, (p - centre).norm());
  if (depth == 0 || std::abs(margin) >= radius) return margin >= 0 ? AreaOf(c) : 0;
  const Eigen::Vector3d a = (c[0] + c[1]) / 2, b = (c[1] + c[2]) / 2, d = (c[2] + c[0]) / 2;
  double area = 0;
  for (const Corners& part :
       {Corners{c[0], a, d}, Corners{a, c[1], b}, Corners{d, b, c[2]}, Corners{a, b, d}})
    area += AreaInside(region, face, part, depth - 1);
  return area;
}

double LayerCount(const Layers& layers) {
  const double last = std::min(layers.finishing, layers.total);
  return std::max(1.0, std::ceil((layers.total - last) / layers.per_layer - 1e-9)) + (last > 0 ? 1 : 0);
}

}  // namespace

double AreaInside(const Region& region, const Region::Patch& patch) {
  constexpr int kDepth = 4;  // of halving the sides of what a border crosses
  double area = 0;
  for (size_t i = 1; i + 1 < patch.corners.size(); ++i)
    area +=
        AreaInside(region, patch.face, {patch.corners[0], patch.corners[i], patch.corners[i + 1]}, kDepth);
  return area;
}

void CheckBudget(const ToolpathOptions& options, const PathCount& count) {
  const double layers = LayerCount(options.layers), passes = std::max(1.0, count.passes);
  const double ends =
      2 * (options.ends.overrun + (options.ends.lead == LeadShape::kNone ? 0 : options.ends.lead_length)) /
      options.spacing;
  const double along = std::max(count.way / options.spacing / passes, 2.0);  // of one pass
  const double points = layers * (std::max(count.covered, passes * along) + passes * ends);
  if (points <= options.budget.most) return;
  // What asks for most: passes side by side, points along them, layers, or what is added at their ends.
  struct Asked {
    double count;
    const char* key;
    double given;
  };
  const bool by_scallop = options.scallop > 0 && count.passes > 0 && count.way / count.passes > 0;
  const std::array<Asked, 4> asked{
      {{passes, by_scallop ? "scallop_mm" : "stepover_mm", by_scallop ? options.scallop : options.stepover},
       {along, "spacing_mm", options.spacing},
       {layers, "depth.per_layer_mm", options.layers.per_layer},
       {ends, "ends.overrun_mm", options.ends.overrun}}};
  const Asked& worst = *std::ranges::max_element(asked, {}, &Asked::count);
  const std::string numbers =
      fmt::format("about {:.3g} points in {:.3g} passes and {:.3g} layers", points, passes * layers, layers);
  const std::string allowed =
      fmt::format("allowed: at most {:.7g} points ({})", options.budget.most, options.budget.set_by);
  if (!options.budget.unit_doubt.empty())
    throw InputError({}, fmt::format("workpiece.unit: {}; the tool path would have {}; {}",
                                     options.budget.unit_doubt, numbers, allowed));
  throw InputError({}, fmt::format("toolpath.{}: given {:.6g}; the tool path would have {}; {}", worst.key,
                                   worst.given, numbers, allowed));
}

}  // namespace millpose
