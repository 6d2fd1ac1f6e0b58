// SPDX-License-Identifier: GPL-3.0-or-later
// Strategy trim: an edge or closed contour, cut through with the side of the cutter.
#include "toolpath/strategies/trim.hpp"

#include "base/error.hpp"
#include "toolpath/strategies/section_check.hpp"
#include "toolpath/strategies/trim_offset.hpp"
#include "toolpath/strategies/trim_track.hpp"
#include "toolpath/strategy_entry.hpp"

namespace millpose {
namespace {

bool IsOpen(const Trim& trim) {
  return trim.border ? !trim.border->between.empty() : trim.line && !trim.line->closed;
}

void CheckOptions(const Trim& trim, const ToolpathOptions& options) {
  std::vector<Problem> problems;
  const auto require = [&](bool holds, const std::string& message) {
    if (!holds) problems.push_back({{}, "toolpath." + message});
  };
  const double radius = options.cutter.radius, depth = trim.through + trim.overcut;
  require(radius > 0, "trim: needs a cutter");
  require(options.spacing > 0, fmt::format("spacing_mm: must be above 0, given {}", options.spacing));
  require(options.chord_tolerance > 0,
          fmt::format("chord_tolerance_mm: must be above 0, given {}", options.chord_tolerance));
  require(trim.through > 0, fmt::format("trim.through_mm: must be above 0, given {}", trim.through));
  require(depth <= options.cutter.length + 1e-9,
          fmt::format(
              "trim: through_mm and overcut_mm come to {:.6g} mm, and the cutter cuts over {:.6g} mm of its "
              "length: its shank would rub",
              depth, options.cutter.length));
  require(!trim.per_depth || *trim.per_depth > 0, "trim.per_depth_mm: must be above 0");
  require(trim.entry != TrimEntry::kHelix || trim.LeadRadius(radius) <= radius + 1e-9,
          fmt::format(
              "trim.lead_radius_mm: given {:.6g}; a helix of more than the cutter's radius, {:.6g} mm, would "
              "leave a core standing; give entry: plunge or a smaller one",
              trim.LeadRadius(radius), radius));
  require(!trim.tabs || trim.tabs->height < trim.through, "trim.tabs.height_mm: must be below through_mm");
  require(trim.entry != TrimEntry::kPlunge || options.centre_cutting,
          "trim.entry: given plunge, but the tool says nothing of centre_cutting: give entry: helix, or "
          "tool.cutter.centre_cutting: true");
  require(trim.entry != TrimEntry::kHelix || trim.ramp <= options.max_ramp + 1e-12,
          fmt::format("trim.ramp_deg: given {:.6g}; allowed: at most tool.cutter.max_ramp_deg, {:.6g}",
                      RadToDeg(trim.ramp), RadToDeg(options.max_ramp)));
  if (!problems.empty()) throw InputError(std::move(problems));
}

void CheckCount(const Trim& trim, const ToolpathOptions& options, const OffsetPath& path) {
  double length = 0;
  for (size_t i = 0; i < path.Segments(); ++i) length += (path.To(i).place - path.From(i).place).norm();
  const double depth = trim.through + trim.overcut, rounds = depth / trim.per_depth.value_or(depth);
  const double points = std::max(1.0, rounds) * length / options.spacing * options.parts;
  if (points > options.budget.most)
    throw InputError(
        {}, fmt::format("toolpath.spacing_mm: given {:.6g}; the trim would have about {:.3g} points; "
                        "allowed: at most {:.7g} points ({})",
                        options.spacing, points, options.budget.most, options.budget.set_by));
}

std::string CornerText(const TightCorner& corner, double diameter) {
  const Eigen::Vector3d& p = corner.place;
  return fmt::format(
      "toolpath.trim: the corner at ({:.3f}, {:.3f}, {:.3f}) mm in the workpiece frame is tighter than "
      "the cutter of {:.6g} mm, which leaves {:.3f} mm standing there",
      p.x(), p.y(), p.z(), diameter, corner.left);
}

constexpr double kToldLean = 0.015;  // degrees

std::string LeanText(double lean, double length) {
  return fmt::format(
      "toolpath.trim: the tool axis, averaged over {:.6g} mm of the way, leans by up to {:.2f} degrees from "
      "that of the contour beside it",
      length, RadToDeg(lean));
}

using yaml::Context;
using yaml::Value;

// Keys that nothing would follow as the others stand.
class TrimCheck : SectionCheck {
 public:
  TrimCheck(const Value& value, const Context& context, const Trim& trim)
      : SectionCheck(value, context), trim_(trim) {}

  void Run() const {
    if (trim_.border.has_value() == trim_.line.has_value())
      context_.Add(value_.mark, trim_.line ? "given border and line; allowed: one of both"
                                           : "missing; required: border or line");
    if (trim_.border) CheckBorder();
    if (trim_.line) CheckLine();
    if (IsOpen(trim_))
      for (const char* key : {"overlap_mm", "start_mm"}) Useless(key, "the contour is open");
    if (trim_.entry == TrimEntry::kPlunge && !trim_.tabs)
      Useless("ramp_deg", "entry is plunge, and there are no tabs");
    if (trim_.tabs && trim_.tabs->count.has_value() == !trim_.tabs->places.empty())
      Add("tabs", "allowed: one of the keys count and at_mm");
    if (trim_.tabs && trim_.tabs->height >= trim_.through)
      Add("tabs", fmt::format("height_mm: given {}; allowed: less than through_mm, {}", trim_.tabs->height,
                              trim_.through));
  }

 private:
  void CheckBorder() const {
    const size_t count = trim_.border->between.size();
    if (count != 0 && count != 2)
      Add("border", fmt::format("between_mm: given {} places; allowed: 2", count));
    if (count == 2 && !trim_.border->near)
      Add("border", "near_mm: missing; required with between_mm, to say which of both ways is meant");
  }

  void CheckLine() const {
    const TrimLine& line = *trim_.line;
    const size_t least = line.closed ? 3 : 2;
    if (line.points.size() < least)
      Add("line", fmt::format("points_mm: given {} points; allowed: {} or more", line.points.size(), least));
    if (!line.closed && (line.side == LineSide::kInside || line.side == LineSide::kOutside))
      Add("line", "side: an open line has a left and a right");
  }

  const Trim& trim_;
};

yaml::Codec<TrimBorder> BorderFields() {
  using S = TrimBorder;
  using namespace yaml;
  return Section<S>(
      {Key<S>("near_mm", MILLPOSE_AT(near), Maybe(yaml::Coordinates()),
              "The border that comes nearest to this place; needed where the region has several."),
       Key<S>("between_mm", MILLPOSE_AT(between), ListOf(yaml::Coordinates()),
              "Only the stretch between the places of the border that are nearest to these two; near_mm lies "
              "by it.")
           .WhenSet([](const S& s) { return !s.between.empty(); })});
}

yaml::Codec<TrimLine> LineFields() {
  using S = TrimLine;
  using namespace yaml;
  return Section<S>(
      {Key<S>("points_mm", MILLPOSE_AT(points), ListOf(yaml::Coordinates()),
              "On the part's surface, in the workpiece frame; straight between them.")
           .Required(),
       Key<S>("closed", MILLPOSE_AT(closed), Flag(), "Whether the last point is joined to the first."),
       Key<S>("side", MILLPOSE_AT(side),
              ChoiceOf<LineSide>({{"left", LineSide::kLeft},
                                  {"right", LineSide::kRight},
                                  {"inside", LineSide::kInside},
                                  {"outside", LineSide::kOutside}}),
              "Where the cutter runs, seen against the tool axis along the points; the part that is kept "
              "lies on the "
              "other.")
           .Required(),
       Key<S>("blank", MILLPOSE_AT(blank), Flag(),
              "The mesh is uncut along the line: what the cutter takes off there is no gouge.")});
}

yaml::Codec<TrimTabs> TabFields() {
  using S = TrimTabs;
  using namespace yaml;
  return Section<S>(
      {Key<S>("count", MILLPOSE_AT(count), Maybe(Integer(1, 1000)), "Evenly along the contour, or:"),
       Key<S>("at_mm", MILLPOSE_AT(places), ListOf(yaml::Coordinates()),
              "one nearest to each of these places.")
           .WhenSet([](const S& s) { return !s.places.empty(); }),
       Key<S>("width_mm", MILLPOSE_AT(width), Real(kMm, Positive(1000)), "Along the contour, at the top.")
           .Required(),
       Key<S>("height_mm", MILLPOSE_AT(height), Real(kMm, Positive(1000)), "Over the part's far side.")
           .Required()});
}

std::vector<yaml::Field<Trim>> WayKeys() {
  using S = Trim;
  using namespace yaml;
  return {Key<S>("lead_radius_mm", MILLPOSE_AT(lead_radius), Maybe(Real(kMm, Positive(1000))),
                 "Quarter circles by which the way is entered and left, on the side of the waste; 0.8 of the "
                 "cutter's "
                 "radius by default."),
          Key<S>("overlap_mm", MILLPOSE_AT(overlap), Real(kMm, UpTo(1000)),
                 "A closed contour runs on over its start by this.")
              .WhenSet([](const S& s) { return !IsOpen(s); })
              .DefaultText("2"),
          Key<S>("start_mm", MILLPOSE_AT(start), Maybe(yaml::Coordinates()),
                 "A closed contour begins nearest to this place; by default in the middle of the longest "
                 "straight with "
                 "room for the leads."),
          Key<S>("entry", MILLPOSE_AT(entry),
                 ChoiceOf<TrimEntry>({{"helix", TrimEntry::kHelix}, {"plunge", TrimEntry::kPlunge}}),
                 "Down to depth in turns along the lead-in's circle, or straight where it begins: with a "
                 "cutter that "
                 "cuts over its centre, or into the open."),
          Key<S>("ramp_deg", MILLPOSE_AT(ramp), Real(kDeg, Between(0.1, 60)),
                 "Of the helix and of the tabs' ends.")
              .WhenSet([](const S& s) { return s.entry == TrimEntry::kHelix || s.tabs; })
              .DefaultText("3"),
          Key<S>("tabs", MILLPOSE_AT(tabs), Maybe(TabFields()), "What is left standing to hold the piece.")};
}

yaml::Codec<Trim> TrimFields() {
  using S = Trim;
  using namespace yaml;
  std::vector<Field<S>> fields{
      Key<S>("border", MILLPOSE_AT(border), Maybe(BorderFields()),
             "A border of toolpath.region, rim or edge; the cutter runs where the region is not. Or:"),
      Key<S>("line", MILLPOSE_AT(line), Maybe(LineFields()), "a polyline."),
      Key<S>("milling", MILLPOSE_AT(climb), ChoiceOf<bool>({{"climb", true}, {"conventional", false}}),
             "With the part on the right of a cutter that turns clockwise seen from its holder, or on its "
             "left."),
      Key<S>("through_mm", MILLPOSE_AT(through), Real(kMm, Positive(1000)),
             "Thickness of the part along the tool axis.")
          .Required(),
      Key<S>("overcut_mm", MILLPOSE_AT(overcut), Real(kMm, UpTo(1000)), "Beyond its far side.").Required(),
      Key<S>("per_depth_mm", MILLPOSE_AT(per_depth), Maybe(Real(kMm, Between(0.01, 1000))),
             "Largest depth of a round; by default one round."),
      Key<S>("allowance_mm", MILLPOSE_AT(allowance), Real(kMm, UpTo(1000)), "Left on the edge.")};
  std::ranges::move(WayKeys(), std::back_inserter(fields));
  return Section<S>(std::move(fields), [](const Value& value, const Context& context, S& trim) {
    TrimCheck(value, context, trim).Run();
  });
}

}  // namespace

std::vector<std::string> Trim::WithoutEffect() const {
  return {"stepover_mm",         "stepover_on", "scallop_mm", "direction", "order",   "share",
          "normal_smoothing_mm", "depth",       "ends",       "lead_deg",  "tilt_deg"};
}

LaidPath Trim::Make(const StrategyInputs& inputs, std::stop_token stop) const {
  CheckOptions(*this, inputs.options);
  const CutterShape& cutter = inputs.options.cutter;
  const Contour contour = ContourOf(*this, inputs);
  const Offset offset = OffsetOf(contour,
                                 {.distance = cutter.radius + allowance,
                                  .chord = inputs.options.chord_tolerance,
                                  .crease = inputs.options.crease,
                                  .smoothing = cutter.radius,
                                  .depth = through + overcut},
                                 stop);
  if (offset.paths.empty())
    throw InputError(
        {}, fmt::format("toolpath.trim: the cutter of {:.6g} mm fits nowhere along the contour on that "
                        "side",
                        2 * cutter.radius));
  LaidPath laid;
  for (const TightCorner& corner : offset.corners)
    laid.findings.push_back(CornerText(corner, 2 * cutter.radius));
  if (offset.paths.size() > 1)
    laid.findings.push_back(
        fmt::format("toolpath.trim: the cutter of {:.6g} mm does not pass the contour's narrow "
                    "places: it is trimmed in {} parts",
                    2 * cutter.radius, offset.paths.size()));
  if (offset.lean > DegToRad(kToldLean)) laid.notes.push_back(LeanText(offset.lean, cutter.radius));
  if (contour.closed && !tabs)
    laid.warnings.emplace_back("toolpath.trim: no tabs hold the piece, which falls on the last stroke");
  for (const OffsetPath& path : offset.paths) {
    CheckCount(*this, inputs.options, path);
    laid.toolpath.passes.push_back(TrimPass(*this, inputs.options, contour, path));
  }
  return laid;
}

StrategyEntry TrimStrategyEntry() {
  return EntryOf<Trim>("trim", "Strategy trim: an edge or closed contour, cut through.", TrimFields());
}

}  // namespace millpose
