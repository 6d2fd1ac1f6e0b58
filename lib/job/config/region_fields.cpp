// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/config/fields.hpp"

namespace millpose::config {
namespace {

Codec<RegionBox> BoxFields() {
  using S = RegionBox;
  const auto corner = [](const char* key, auto access, const char* doc) {
    return Key<S>(key, access, Coordinates(), doc).Required();
  };
  const auto check = [](const Value& value, const Context& context, S& box) {
    if (!(box.lower.array() < box.upper.array()).all())
      context.Add(value.mark, "upper_mm must be greater than lower_mm in each coordinate");
  };
  return Section<S>({corner("lower_mm", MILLPOSE_AT(lower), "Lower corner."),
                     corner("upper_mm", MILLPOSE_AT(upper), "Upper corner.")},
                    check);
}

Codec<HalfSpace> HalfSpaceFields() {
  using S = HalfSpace;
  return Section<S>(
      {Key<S>("point_mm", MILLPOSE_AT(point), Coordinates(), "A point of the bounding plane.").Required(),
       Key<S>("normal", MILLPOSE_AT(normal), Direction(), "Points to what is in.").Required()});
}

Codec<ProjectedPolygon> PolygonFields() {
  using S = ProjectedPolygon;
  const auto check = [](const Value& value, const Context& context, S& polygon) {
    if (polygon.points.size() < 3)
      context.Add(value.mark,
                  fmt::format("a polygon needs 3 points or more, given {}", polygon.points.size()));
  };
  return Section<S>(
      {Key<S>("points_mm", MILLPOSE_AT(points), ListOf(Coordinates()), "Corners in order, either way round.")
           .Required(),
       Key<S>("direction", MILLPOSE_AT(direction), Direction(),
              "Along it the polygon is projected onto the part.")
           .Required()},
      check);
}

Codec<ConnectedFaces> ConnectedFields() {
  using S = ConnectedFaces;
  return Section<S>(
      {Key<S>("seed_mm", MILLPOSE_AT(seed), Coordinates(), "A point at the surface.").Required(),
       Key<S>("crease_deg", MILLPOSE_AT(crease), Real(kDeg, Between(0, 180)),
              "The faces end at edges that bend more sharply.")});
}

// The keys that nested conditions have too.
std::vector<Field<RegionOptions>> ConditionKeys() {
  using S = RegionOptions;
  return {
      Key<S>("box", MILLPOSE_AT(box), Maybe(BoxFields()),
             "Only what lies in this box, in the workpiece frame."),
      Key<S>("half_space", MILLPOSE_AT(half_space), Maybe(HalfSpaceFields()),
             "Only what lies on one side of a plane."),
      Key<S>("polygon", MILLPOSE_AT(polygon), Maybe(PolygonFields()),
             "Only what lies in a projected polygon."),
      Key<S>("facing", kSelf,
             Section<S>({Key<S>("direction", MILLPOSE_AT(facing), Maybe(Direction()),
                                "Direction in the workpiece frame.")
                             .Required(),
                         Key<S>("within_deg", MILLPOSE_AT(facing_within), Real(kDeg, Between(0, 180)),
                                "Largest angle between a normal and the direction.")}),
             "Only faces whose normals point this way.")
          .WhenSet([](const S& s) { return s.facing.has_value(); }),
      Key<S>("connected", MILLPOSE_AT(connected), Maybe(ConnectedFields()),
             "Only faces reached from a point without passing a crease."),
      Key<S>("step_faces", MILLPOSE_AT(source_faces), ListOf(Text()),
             "Only these faces of a STEP or IGES part, by number, #id or name (millpose check lists them), "
             "or by a "
             "place on "
             "one: near 10 0 20 (mm, workpiece frame)."),
      Key<S>("rim_distance_mm", MILLPOSE_AT(rim_distance), Real(kMm, UpTo(1e5)),
             "Distance kept from open rims and from edges to faces that are out."),
  };
}

}  // namespace

Codec<RegionOptions> RegionFields() {
  using S = RegionOptions;
  const auto list = [](const char* key, auto access, const char* doc) {
    return Key<S>(key, access, ListOf(Section<S>(ConditionKeys())), doc).WhenSet([access](const S& s) {
      return !access(s).empty();
    });
  };
  std::vector<Field<S>> fields = ConditionKeys();
  fields.push_back(list("all", MILLPOSE_AT(all), "All of these must hold too."));
  fields.push_back(list("any", MILLPOSE_AT(any), "At least one of these must hold."));
  fields.push_back(list("none", MILLPOSE_AT(none), "None of these may hold."));
  return Section<S>(std::move(fields));
}

}  // namespace millpose::config
