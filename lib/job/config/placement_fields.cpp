// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a job's `placement:`, one line each.
#include "job/config/fields.hpp"

namespace millpose::config {
namespace {

void CheckRange(const Value& value, const Context& context, PlaceRange& range) {
  if (range.from >= range.to) context.Add(value.mark, "`to` must be more than `from`");
}

Codec<std::optional<PlaceRange>> RangeFields(const Unit& unit, const Range& range) {
  using S = PlaceRange;
  return Maybe(Section<S>({Key<S>("from", MILLPOSE_AT(from), Real(unit, range), "Least value.").Required(),
                           Key<S>("to", MILLPOSE_AT(to), Real(unit, range), "Greatest value.").Required()},
                          CheckRange));
}

Codec<KeepOutSettings> KeepOutFields() {
  using S = KeepOutSettings;
  return Section<S>({Key<S>("name", MILLPOSE_AT(name), Text(), "For messages.").Required(),
                     Key<S>("shape", MILLPOSE_AT(shape), ShapeFields(), "What it looks like.").Required(),
                     Key<S>("pose", MILLPOSE_AT(pose), PoseFields(), "In the world.").Required()});
}

Codec<StationSettings> StationFields() {
  using S = StationSettings;
  return Section<S>(
      {Key<S>("most", MILLPOSE_AT(most), Integer(2, kMostStations), "Stations at most.").Required(),
       Key<S>("error_mm", MILLPOSE_AT(error), Real(kMm, Positive(1000)),
              "How far off its place on the part a station may mill, after it was measured there: "
              "neighbouring stations overlap by twice as much and a step-over.")
           .Required(),
       Key<S>("along", MILLPOSE_AT(along), Maybe(Direction()),
              "Direction in the workpiece frame across which the part is split.")
           .DefaultText("of its x, y and z the one along which the tool path is longest"),
       Key<S>("gain_percent", MILLPOSE_AT(gain), Maybe(Real(kPercent, Between(0.1, 99))),
              "By how much the objective's worst value must fall for one station more.")
           .DefaultText("a station more is for points alone that fewer leave out")});
}

void CheckAny(const Value& value, const Context& context, PlacementSettings& placement) {
  for (const std::string& direction : placement.map) {
    const auto key = std::ranges::find(kPlaceKeys, direction) - kPlaceKeys.begin();
    if (!placement.ranges[static_cast<size_t>(key)])
      context.Child("map").Add(value.FindKey("map")->mark,
                               fmt::format("given {}, which has no range", direction));
  }
  if (placement.map.size() > 2 || (placement.map.size() == 2 && placement.map[0] == placement.map[1]))
    context.Child("map").Add(value.FindKey("map")->mark, "give one direction or two different ones");
  if (std::ranges::none_of(placement.ranges, [](const auto& range) { return range.has_value(); }))
    context.Add(value.mark,
                fmt::format("give a range for one of {} or for several", fmt::join(kPlaceKeys, ", ")));
}

}  // namespace

Codec<PlacementSettings> PlacementFields() {
  using S = PlacementSettings;
  const Range length = Between(-100000, 100000), angle = Between(-360, 360);
  return Section<S>(
      {
          Key<S>("x_mm", MILLPOSE_AT(ranges[0]), RangeFields(kMm, length),
                 "Of `workpiece.pose`, or of `base_in_world` where the robot moves: between which values its "
                 "xyz_mm[0] may lie; missing: stays."),
          Key<S>("y_mm", MILLPOSE_AT(ranges[1]), RangeFields(kMm, length), "Likewise xyz_mm[1]."),
          Key<S>("z_mm", MILLPOSE_AT(ranges[2]), RangeFields(kMm, length), "Likewise xyz_mm[2]."),
          Key<S>("a_deg", MILLPOSE_AT(ranges[3]), RangeFields(kDeg, angle), "Likewise abc_deg[0]."),
          Key<S>("b_deg", MILLPOSE_AT(ranges[4]), RangeFields(kDeg, angle), "Likewise abc_deg[1]."),
          Key<S>("c_deg", MILLPOSE_AT(ranges[5]), RangeFields(kDeg, angle), "Likewise abc_deg[2]."),
          Key<S>("moves", MILLPOSE_AT(moves),
                 ChoiceOf<PlaceMoves>({{"part", PlaceMoves::kPart}, {"robot", PlaceMoves::kRobot}}),
                 "What is placed; the rest of the cell stays."),
          Key<S>("points", MILLPOSE_AT(points), Integer(1, 100000),
                 "Points of the tool path that are checked in every place, spread over it."),
          Key<S>("places", MILLPOSE_AT(places), Integer(1, 1000000), "Places that are tried."),
          Key<S>("plans", MILLPOSE_AT(plans), Integer(1, 100),
                 "How many of the best places are planned completely."),
          Key<S>("map", MILLPOSE_AT(map),
                 ListOf(Choice(std::vector<std::string>(kPlaceKeys.begin(), kPlaceKeys.end()))),
                 "Over which one or two of the directions the map is drawn.")
              .DefaultText("the first two that have a range"),
          Key<S>("map_points", MILLPOSE_AT(map_points), Integer(2, 1001),
                 "Of the map, along each of its directions."),
          Key<S>("keep_out", MILLPOSE_AT(keep_out), ListOf(KeepOutFields()),
                 "Where what moves must not be, in addition to the cell's bodies."),
          Key<S>("stations", MILLPOSE_AT(stations), Maybe(StationFields()),
                 "The part may be split between several places; by default it is milled from one."),
      },
      CheckAny);
}

}  // namespace millpose::config
