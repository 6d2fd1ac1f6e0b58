// SPDX-License-Identifier: GPL-3.0-or-later
// Strategy rough: the stock over the part, layer by layer across the tool axis.
#include "toolpath/strategies/rough.hpp"

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/trig.hpp"
#include "toolpath/strategies/rough_layer.hpp"
#include "toolpath/strategies/rough_levels.hpp"
#include "toolpath/strategy_entry.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

constexpr double kBelowTarget = 0.95;   // of the engagement: what the lattice may not see
constexpr double kThinMaterial = 0.02;  // mm over a layer's floor that count as none
constexpr double kShortest = 0.05;      // mm, between points

void CheckOptions(const Rough& rough, const ToolpathOptions& options) {
  std::vector<Problem> problems;
  const auto require = [&](bool holds, const std::string& message) {
    if (!holds) problems.push_back({{}, "toolpath." + message});
  };
  const CutterShape& cutter = options.cutter;
  const double step = cutter.radius * (1 - SinCos(rough.max_engagement).cos);
  require(cutter.radius > 0, "rough: needs a cutter");
  require(options.spacing > 0, fmt::format("spacing_mm: must be above 0, given {}", options.spacing));
  require(options.chord_tolerance > 0,
          fmt::format("chord_tolerance_mm: must be above 0, given {}", options.chord_tolerance));
  require(options.tool_axis.rule == AxisRule::kFixed,
          "tool_axis: strategy rough mills in layers across one direction; give rule: fixed, direction");
  require(
      rough.per_layer <= cutter.length + 1e-9,
      fmt::format("rough.per_layer_mm: given {:.6g}; allowed: at most the cutter's cutting length, {:.6g}",
                  rough.per_layer, cutter.length));
  require(
      cutter.corner_radius <= cutter.radius - step / 2 && cutter.corner_radius < cutter.radius / 2,
      fmt::format("rough: the cutter's corner radius is {:.6g} mm; allowed: below {:.6g} mm, so that cuts "
                  "leave no ridges on the floor",
                  cutter.corner_radius, std::min(cutter.radius - step / 2, cutter.radius / 2)));
  require(rough.ramp <= options.max_ramp + 1e-12,
          fmt::format("rough.ramp_deg: given {:.6g}; allowed: at most tool.cutter.max_ramp_deg, {:.6g}",
                      RadToDeg(rough.ramp), RadToDeg(options.max_ramp)));
  if (!problems.empty()) throw InputError(std::move(problems));
}

/// Lays the points of a pass on straight lines from place to place.
class RoughPoints {
 public:
  RoughPoints(const ToolpathOptions& options, const Eigen::Matrix3d& across)
      : options_(options), across_(across) {}

  Pass Make(const std::vector<RoughVertex>& way) {
    pass_ = {};
    pass_.rotation_reference = options_.rotation_reference;
    std::vector<RoughVertex> kept{way.front()};
    for (size_t i = 1; i < way.size(); ++i) {
      const bool last = i + 1 == way.size();
      if ((way[i].place - kept.back().place).norm() >= kShortest)
        kept.push_back(way[i]);
      else if (last && kept.size() > 1)
        kept.back() = way[i];
    }
    if (kept.size() < 2) return std::move(pass_);
    Add(kept[0].place, Along(kept, 1), kept[1].motion);
    for (size_t i = 1; i < kept.size(); ++i) Go(kept, i);
    return std::move(pass_);
  }

 private:
  static Vector3d Along(const std::vector<RoughVertex>& way, size_t i) {
    Vector3d along = way[i].place - way[i - 1].place;
    along.z() = 0;
    return along.normalized();
  }

  void Go(const std::vector<RoughVertex>& way, size_t i) {
    const Vector3d &from = way[i - 1].place, &to = way[i].place;
    const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / options_.spacing - 1e-9))) *
                      std::max(1, options_.parts);
    const Vector3d along = Along(way, i);
    for (int k = 1; k < steps; ++k)
      Add(from + static_cast<double>(k) / steps * (to - from), along, way[i].motion);
    Vector3d both = along;
    if (i + 1 < way.size()) both += Along(way, i + 1);
    Add(to, both.norm() > 1e-3 ? Vector3d(both.normalized()) : along, way[i].motion);
  }

  double Feed(RoughMotion motion) const {
    if (motion == RoughMotion::kEntry && options_.plunge_feed > 0) return options_.plunge_feed;
    if (motion == RoughMotion::kAir && options_.retract_feed > 0) return options_.retract_feed;
    return options_.feed_rate;
  }

  void Add(const Vector3d& place, const Vector3d& along, RoughMotion motion) {
    MillingPoint point;
    point.position = across_.transpose() * place;
    point.normal = point.tool_axis = across_.row(2).transpose();
    point.feed = across_.transpose() * along;
    point.feed_rate = Feed(motion);
    point.kind = motion == RoughMotion::kEntry ? PointKind::kLeadIn : PointKind::kCut;
    if (!pass_.points.empty())
      point.arc_length =
          pass_.points.back().arc_length + (point.position - pass_.points.back().position).norm();
    pass_.points.push_back(point);
  }

  const ToolpathOptions& options_;
  const Eigen::Matrix3d& across_;
  Pass pass_;
};

RoughLayer LayerAt(const Rough& rough, const StrategyInputs& inputs, const RoughScene& scene, double above,
                   double floor, const std::stop_token& stop) {
  const ToolpathOptions& options = inputs.options;
  const double disc = RoughDisc(options.cutter);
  const RoughBound bound(scene.part, options.cutter, rough.allowance, floor);
  const RoughRoom room(bound, scene.grid, 2 * options.cutter.radius);
  std::vector<char> stands(scene.grid.size());
  const double thin = std::max(kThinMaterial, rough.thicker_than);
  for (size_t cell = 0; cell < stands.size(); ++cell) stands[cell] = scene.tops[cell] > floor + thin;
  if (rough.thicker_than > 0) stands = ThickerThan(scene.grid, stands, rough.thicker_than);
  return RoughLayerOf(RoughMaterial(scene.grid, std::move(stands), disc), room, scene.tops,
                      {.march = {kBelowTarget * rough.max_engagement, rough.climb},
                       .cutter = options.cutter,
                       .centre_cutting = options.centre_cutting,
                       .ramp = rough.ramp,
                       .chord = options.chord_tolerance,
                       .floor = floor,
                       .above = above},
                      stop);
}

void TellWhatIsLeft(const Rough& rough, const RoughScene& scene, const RoughLayer& layer, double above,
                    double floor, LaidPath& laid) {
  constexpr double kWorthTelling = 0.05;  // of the area of a square on the lattice's forty cells
  const double side = 40 * scene.grid.cell;
  if (layer.left < kWorthTelling * side * side) return;
  const Vector3d place = scene.across.transpose() * Vector3d(layer.left_at.x(), layer.left_at.y(), floor);
  laid.findings.push_back(fmt::format(
      "toolpath.rough: about {:.2f} cm3 stay in the layer {:.3f} mm along the tool axis, first at ({:.1f}, "
      "{:.1f}, {:.1f}) mm in the workpiece frame, where the cutter would fit: {}",
      layer.left * (above - floor) / 1e3, floor, place.x(), place.y(), place.z(),
      layer.without_entry ? "there is no room for a helix or ramp; drill it before, or give a smaller tool"
                          : fmt::format("it is too narrow to keep to {:.6g} degrees of engagement",
                                        RadToDeg(rough.max_engagement))));
}

yaml::Codec<Rough> RoughFields() {
  using S = Rough;
  using namespace yaml;
  return Section<S>(
      {Key<S>("allowance_mm", MILLPOSE_AT(allowance), Real(kMm, UpTo(1000)), "Left on the part.").Required(),
       Key<S>("per_layer_mm", MILLPOSE_AT(per_layer), Real(kMm, Between(0.01, 1000)),
              "Largest depth of a layer, along the tool axis.")
           .Required(),
       Key<S>("max_engagement_deg", MILLPOSE_AT(max_engagement), Real(kDeg, Between(20, 150)),
              "How far round the cutter its edge may be in the material at once, entries apart; 90 is half a "
              "slot."),
       Key<S>("milling", MILLPOSE_AT(climb), ChoiceOf<bool>({{"climb", true}, {"conventional", false}}),
              "With the material on the right of a cutter that turns clockwise seen from its holder, or on "
              "its left."),
       Key<S>("ramp_deg", MILLPOSE_AT(ramp), Real(kDeg, Between(0.1, 60)),
              "Of the helix or ramp into a layer that is open to no side."),
       Key<S>("thicker_than_mm", MILLPOSE_AT(thicker_than), Real(kMm, UpTo(1000)),
              "Material that is thinner counts as none: what an earlier, larger tool has left in corners is "
              "taken off alone."),
       Key<S>("bottom_mm", MILLPOSE_AT(bottom), Maybe(Real(kMm, Between(-1e5, 1e5))),
              "Lowest height of the tip, along the tool axis from the workpiece frame's origin; by default "
              "the allowance over the part's lowest place.")});
}

}  // namespace

std::vector<std::string> Rough::WithoutEffect() const {
  return {"region",    "share",    "stepover_mm", "stepover_on",         "scallop_mm",
          "direction", "order",    "crease_deg",  "normal_smoothing_mm", "depth",
          "ends",      "lead_deg", "tilt_deg"};
}

LaidPath Rough::Make(const StrategyInputs& inputs, std::stop_token stop) const {
  CheckOptions(*this, inputs.options);
  if (!inputs.stock) throw InputError({}, "toolpath.rough: needs workpiece.stock");
  const RoughScene scene = RoughSceneOf(inputs, inputs.options.tool_axis.direction);
  const std::vector<double> levels = RoughLevels(*this, scene);
  const double top = *std::ranges::max_element(scene.tops);
  const auto above = [&](size_t i) { return i == 0 ? top : levels[i - 1]; };
  std::vector<RoughLayer> layers(levels.size());
  ParallelFor(levels.size(), inputs.threads, stop,
              [&](size_t i) { layers[i] = LayerAt(*this, inputs, scene, above(i), levels[i], stop); });
  LaidPath laid;
  RoughPoints points(inputs.options, scene.across);
  size_t count = 0;
  for (size_t i = 0; i < layers.size(); ++i) {
    for (const std::vector<RoughVertex>& way : layers[i].passes) {
      Pass pass = points.Make(way);
      count += pass.points.size();
      if (pass.points.size() > 1) laid.toolpath.passes.push_back(std::move(pass));
    }
    TellWhatIsLeft(*this, scene, layers[i], above(i), levels[i], laid);
  }
  const PointBudget& budget = inputs.options.budget;
  if (static_cast<double>(count) > budget.most)
    throw InputError({}, fmt::format("toolpath.rough: has {} points; allowed: at most {:.7g} ({}); give a "
                                     "larger per_layer_mm, spacing_mm or chord_tolerance_mm",
                                     count, budget.most, budget.set_by));
  if (laid.toolpath.passes.empty())
    throw InputError({},
                     "toolpath.rough: nothing to take off: the cutter reaches nothing that stands over "
                     "the part and its allowance");
  return laid;
}

StrategyEntry RoughStrategyEntry() {
  return EntryOf<Rough>("rough", "Strategy rough: the stock over the part, layer by layer.", RoughFields());
}

}  // namespace millpose
