// SPDX-License-Identifier: GPL-3.0-or-later
// Strategy drill: holes of the job or of the part, each straight along its axis.
#include "toolpath/strategies/drill.hpp"

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "toolpath/cam/drilling.hpp"
#include "toolpath/strategies/drill_holes.hpp"
#include "toolpath/strategies/section_check.hpp"
#include "toolpath/strategy_entry.hpp"

namespace millpose {
namespace {

// Lays the points of one hole.
class HoleMaker {
 public:
  HoleMaker(const Drill& drill, const ToolpathOptions& options)
      : drill_(drill),
        options_(options),
        plunge_(options.plunge_feed > 0 ? options.plunge_feed : options.feed_rate),
        retract_(options.retract_feed > 0 ? options.retract_feed : options.feed_rate) {}

  Pass Make(const DrilledHole& hole) {
    hole_ = &hole;
    pass_ = {};
    pass_.whole = true;
    pass_.rotation_reference = options_.rotation_reference;
    Add(hole.top + drill_.clearance, plunge_, PointKind::kLeadIn);
    const Drilling drilling = Strokes();
    double done = at_ - drill_.clearance;  // how deep the hole is already
    const std::vector<double> heights = Heights(drilling, {});
    for (size_t i = 0; i < heights.size(); ++i) {
      const bool last = i + 1 == heights.size();
      if (heights[i] > at_) {
        Go(heights[i], retract_, last ? PointKind::kLeadOut : PointKind::kCut);
        continue;
      }
      // Down again in what is drilled already, as fast as out of it.
      if (at_ > done + drill_.clearance + 1e-9) Go(done + drill_.clearance, retract_, PointKind::kCut);
      Go(heights[i], plunge_, PointKind::kCut);
      done = heights[i];
    }
    return std::move(pass_);
  }

  /// Points that a hole takes at least.
  double LeastPoints(const DrilledHole& hole) const {
    return 2 * (hole.top + drill_.clearance + hole.depth) / options_.spacing * options_.parts;
  }

 private:
  Drilling Strokes() const {
    Drilling drilling;
    drilling.clearance = at_;
    drilling.bottoms = {-hole_->depth};
    if (drill_.peck) {
      drilling.bottoms = EvenStrokes(hole_->top, -hole_->depth, *drill_.peck, {});
      drilling.chip_retract = drill_.chip_retract.value_or(0);
    }
    return drilling;
  }

  void Go(double height, double feed, PointKind kind) {
    const double from = at_, way = std::abs(height - from);
    const int steps =
        std::max(1, static_cast<int>(std::ceil(way / options_.spacing - 1e-9))) * std::max(1, options_.parts);
    for (int k = 1; k <= steps; ++k)
      Add(k == steps ? height : from + (height - from) * (static_cast<double>(k) / steps), feed, kind);
  }

  void Add(double height, double feed, PointKind kind) {
    MillingPoint point;
    point.position = hole_->entrance + height * hole_->axis;
    point.normal = point.tool_axis = hole_->axis;
    point.feed = hole_->axis.unitOrthogonal();
    point.feed_rate = feed;
    point.kind = kind;
    point.own = OwnCut{hole_->top - height, hole_->out - height};
    if (!pass_.points.empty()) point.arc_length = pass_.points.back().arc_length + std::abs(height - at_);
    pass_.points.push_back(point);
    at_ = height;
  }

  const Drill& drill_;
  const ToolpathOptions& options_;
  double plunge_, retract_;
  const DrilledHole* hole_ = nullptr;
  Pass pass_;
  double at_ = 0;  // height of the last point
};

void CheckCount(const HoleMaker& maker, const std::vector<DrilledHole>& holes,
                const ToolpathOptions& options) {
  if (!(options.spacing > 0))
    throw InputError({}, fmt::format("toolpath: the spacing must be above 0 mm, given {}", options.spacing));
  double points = 0;
  for (const DrilledHole& hole : holes) points += maker.LeastPoints(hole);
  if (points > options.budget.most)
    throw InputError({}, fmt::format("toolpath.spacing_mm: given {:.6g}; the holes would have about {:.3g} "
                                     "points; allowed: at most {:.7g} points ({})",
                                     options.spacing, points, options.budget.most, options.budget.set_by));
}

using yaml::Context;
using yaml::Value;

const yaml::Unit kSecond{"s", 1, 1};

// Keys that nothing would follow as the others stand.
class DrillCheck : SectionCheck {
 public:
  DrillCheck(const Value& value, const Context& context, const Drill& drill)
      : SectionCheck(value, context), drill_(drill) {}

  void Run() const {
    if (drill_.holes.empty() == !drill_.circles)
      context_.Add(value_.mark, drill_.circles ? "given holes and circles; allowed: one of both"
                                               : "missing; required: holes or circles");
    if (drill_.countersink) return CheckCountersink();
    if (drill_.chip_retract && !drill_.peck) Useless("chip_retract_mm", "needs peck_mm");
    if (drill_.chip_retract && drill_.peck && *drill_.chip_retract >= *drill_.peck)
      Add("chip_retract_mm",
          fmt::format("given {} mm; allowed: less than peck_mm, {} mm", *drill_.chip_retract, *drill_.peck));
    if (drill_.circles) {
      if (drill_.depth && drill_.breakthrough) Useless("breakthrough_mm", "depth_mm says how deep holes are");
      return;
    }
    if (drill_.breakthrough) Useless("breakthrough_mm", "holes of a list are as deep as their depth_mm");
    size_t own = 0;
    const Value* list = value_.Find("holes");
    for (size_t i = 0; i < drill_.holes.size(); ++i) {
      own += drill_.holes[i].depth ? 1 : 0;
      if (!drill_.holes[i].depth && !drill_.depth)
        context_.Child("holes")
            .Child(i)
            .Child("depth_mm")
            .Add(list->items[i].mark, "missing; required where drill.depth_mm is not given");
    }
    if (drill_.depth && own == drill_.holes.size()) Useless("depth_mm", "every hole has its own");
  }

 private:
  void CheckCountersink() const {
    const Countersink& sink = *drill_.countersink;
    for (const char* key : {"depth_mm", "breakthrough_mm", "peck_mm", "chip_retract_mm"})
      Useless(key, "countersink says how deep the tool goes, in one stroke");
    if (const Value* list = value_.Find("holes"))
      for (size_t i = 0; i < drill_.holes.size(); ++i)
        if (drill_.holes[i].depth)
          context_.Child("holes")
              .Child(i)
              .Child("depth_mm")
              .Add(list->items[i].mark, "has no effect here: countersink says how deep the tool goes");
    if (sink.diameter.has_value() == sink.depth.has_value())
      Add("countersink", "allowed: one of the keys diameter_mm and depth_mm");
    if (sink.diameter && drill_.point_angle >= kPi)
      Add("countersink", "diameter_mm needs drill.point_deg, the angle of the cutter's cone, below 180");
    if (sink.depth) Useless("point_deg", "countersink.depth_mm is the tip's");
  }

  const Drill& drill_;
};

yaml::Codec<HolePlace> HoleFields() {
  using S = HolePlace;
  using namespace yaml;
  return Section<S>(
      {Key<S>("at_mm", MILLPOSE_AT(entrance), yaml::Coordinates(),
              "Middle of its entrance, in the workpiece frame.")
           .Required(),
       Key<S>("axis", MILLPOSE_AT(axis), yaml::Direction(),
              "Out of the material, to where the tool comes from.")
           .Required(),
       Key<S>("depth_mm", MILLPOSE_AT(depth), Maybe(Real(kMm, Positive(1000))),
              "From the entrance to the end of the full diameter; drill.depth_mm by default.")});
}

yaml::Codec<CircleChoice> CircleFields() {
  using S = CircleChoice;
  using namespace yaml;
  return Section<S>({Key<S>("diameter_mm", MILLPOSE_AT(diameter), Real(kMm, Positive(1000)),
                            "Of the holes that are drilled; `millpose check` lists those of a part.")
                         .Required(),
                     Key<S>("tolerance_mm", MILLPOSE_AT(tolerance), Real(kMm, Between(0.001, 10)),
                            "How far diameters may differ from that, and corners from the circle."),
                     Key<S>("from", MILLPOSE_AT(from), Maybe(yaml::Direction()),
                            "The side that the tool comes from; required where a hole has two ends.")});
}

yaml::Codec<Countersink> CountersinkFields() {
  using S = Countersink;
  using namespace yaml;
  return Section<S>({Key<S>("diameter_mm", MILLPOSE_AT(diameter), Maybe(Real(kMm, Positive(1000))),
                            "Of the sink at the entrance."),
                     Key<S>("depth_mm", MILLPOSE_AT(depth), Maybe(Real(kMm, Positive(1000))),
                            "Of the cutter's tip under the entrance.")});
}

yaml::Codec<Drill> DrillFields() {
  using S = Drill;
  using namespace yaml;
  return Section<S>(
      {Key<S>("holes", MILLPOSE_AT(holes), ListOf(HoleFields()), "Holes one by one, or:")
           .WhenSet([](const S& s) { return !s.holes.empty(); }),
       Key<S>(
           "circles", MILLPOSE_AT(circles), Maybe(CircleFields()),
           "the round holes of the part that lie in toolpath.region: cylindrical walls, of STEP parts as of "
           "meshes, and circular rims of open sheets."),
       Key<S>("depth_mm", MILLPOSE_AT(depth), Maybe(Real(kMm, Positive(1000))),
              "From the entrance to the end of the full diameter; of circles with a wall by default as deep "
              "as the wall."),
       Key<S>("breakthrough_mm", MILLPOSE_AT(breakthrough), Maybe(Real(kMm, UpTo(1000))),
              "Circles that go through: how far the full diameter goes on beyond the far end."),
       Key<S>("point_deg", MILLPOSE_AT(point_angle), Real(kDeg, Between(10, 180)),
              "Angle of the drill's point, by which the tip lies under the end of the full diameter.")
           .WhenSet([](const S& s) { return !s.countersink || !s.countersink->depth; })
           .DefaultText("180"),
       Key<S>("clearance_mm", MILLPOSE_AT(clearance), Real(kMm, Between(0.1, 1000)),
              "Over the entrance: where the feed into the hole begins."),
       Key<S>("peck_mm", MILLPOSE_AT(peck), Maybe(Real(kMm, Between(0.01, 1000))),
              "Largest depth of a stroke; none: each hole in one."),
       Key<S>("chip_retract_mm", MILLPOSE_AT(chip_retract), Maybe(Real(kMm, Between(0.01, 1000))),
              "Between strokes the tool goes back by this, to break chips; by default out of the hole."),
       Key<S>("dwell_s", MILLPOSE_AT(dwell), Real(kSecond, UpTo(60)),
              "At the bottom of a hole or a countersink the tool stands this long before it goes back."),
       Key<S>("countersink", MILLPOSE_AT(countersink), Maybe(CountersinkFields()),
              "Holes are countersunk instead, in one stroke; one of both keys.")},
      [](const Value& value, const Context& context, S& drill) { DrillCheck(value, context, drill).Run(); });
}

}  // namespace

std::vector<std::string> Drill::WithoutEffect() const {
  std::vector<std::string> keys{
      "stepover_mm", "stepover_on", "scallop_mm", "direction", "normal_smoothing_mm",
      "depth",       "ends",        "tool_axis",  "lead_deg",  "tilt_deg"};
  if (!circles) keys.insert(keys.end(), {"region", "crease_deg"});
  return keys;
}

// A hole is drilled from one station: where its entrance lies.
void KeepShare(const PathSection& share, std::vector<DrilledHole>& holes) {
  if (share.overlap > 0)
    throw InputError({},
                     "toolpath.share.overlap_mm: has no effect with strategy drill: a hole is drilled from "
                     "one station; leave it out");
  std::erase_if(holes, [&](const DrilledHole& hole) { return !share.Owns(hole.entrance); });
  if (holes.empty()) throw InputError({}, "toolpath.share: no hole lies in it");
}

LaidPath Drill::Make(const StrategyInputs& inputs, std::stop_token stop) const {
  LaidPath laid;
  std::vector<DrilledHole> drilled = HolesOf(*this, inputs, laid.warnings);
  if (inputs.options.share) KeepShare(*inputs.options.share, drilled);
  HoleMaker maker(*this, inputs.options);
  CheckCount(maker, drilled, inputs.options);
  std::vector<Eigen::Vector3d> entrances;
  for (const DrilledHole& hole : drilled) entrances.push_back(hole.entrance);
  std::vector<size_t> order(drilled.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  if (inputs.options.order_by_travel) order = ShortWay(entrances);
  for (const size_t i : order) {
    CheckStop(stop);
    laid.toolpath.passes.push_back(maker.Make(drilled[i]));
  }
  return laid;
}

StrategyEntry DrillEntry() {
  return EntryOf<Drill>("drill", "Strategy drill: holes along their axes.", DrillFields());
}

}  // namespace millpose
