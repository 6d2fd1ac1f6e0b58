// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a job's `program_options:`, one line each.
#include "job/config/fields.hpp"

namespace millpose::config {

namespace {

constexpr double kMostShare = 0.8;  // of the path's tolerance that points left out may use up

void CheckEconomy(const Value& value, const Context& context, ProgramOptionSettings& options) {
  const Value* economy = value.Find("point_economy");
  const auto check = [&](const char* key, const std::optional<double>& given, double tolerance,
                         const Unit& unit) {
    if (!given || *given <= kMostShare * tolerance * (1 + 1e-9)) return;
    context.Child("point_economy")
        .Child(key)
        .Add(economy->Find(key)->mark,
             fmt::format("given {} {}; allowed: at most 0.8 of the path's tolerance, {}",
                         ShortestIn(unit, *given), unit.label, ShortestIn(unit, kMostShare * tolerance)));
  };
  check("chord_mm", options.chord_tolerance, options.path_tolerance, kMm);
  check("angle_deg", options.angle_tolerance, options.path_angle, kDeg);
}

}  // namespace

Codec<ProgramOptionSettings> ProgramOptionFields() {
  using S = ProgramOptionSettings;
  return Section<S>(
      {
          Key<S>(
              "path_tolerance_mm", MILLPOSE_AT(path_tolerance), Real(kMm, Between(0.01, 1)),
              "How far a controller may take the tip off the planned path, corners rounded included. The "
              "default is well below what an arm repeats to, about 0.1 mm; a larger one lets it run faster."),
          Key<S>("path_tolerance_deg", MILLPOSE_AT(path_angle), Real(kDeg, Between(0.01, 1)),
                 "Likewise for the tool's orientation."),
          Key<S>(
              "point_economy", kSelf,
              Section<S>({
                  Key<S>("chord_mm", MILLPOSE_AT(chord_tolerance), Maybe(Real(kMm, Between(0, 1))),
                         "A point is left out where the controller's own motion passes it this near; 0 keeps "
                         "every point. At most 0.8 of path_tolerance_mm.")
                      .DefaultText("half of path_tolerance_mm"),
                  Key<S>("angle_deg", MILLPOSE_AT(angle_tolerance), Maybe(Real(kDeg, Between(0, 1))),
                         "Likewise for the tool's orientation; at most 0.8 of path_tolerance_deg.")
                      .DefaultText("0.8 of path_tolerance_deg"),
                  Key<S>("spacing_mm", MILLPOSE_AT(spacing), Real(kMm, UpTo(1000)),
                         "Least distance of points, where the tolerances allow it; nearer ones are counted."),
              }),
              "Points that the controller's own interpolation makes needless are left out."),
          Key<S>("dry_run_offset_mm", MILLPOSE_AT(dry_run_offset), Real(kMm, UpTo(1000)),
                 "Lifts every cut along the tool axis, to see the program run in the air."),
          Key<S>(
              "base_window", kSelf,
              Section<S>({
                  Key<S>("shift_mm", MILLPOSE_AT(base_shift), Real(kMm, UpTo(1000)), "Along X, Y and Z."),
                  Key<S>("turn_deg", MILLPOSE_AT(base_turn), Real(kDeg, Between(0, 5)), "About X, Y and Z."),
              }),
              "With workpiece.targets: how far $BASE may be shifted; reach and clearance are re-verified for "
              "it."),
          Key<S>("date", MILLPOSE_AT(date), Text(), "Printed in the programs' headers; none by default.")
              .WhenSet([](const S& s) { return !s.date.empty(); }),
      },
      CheckEconomy);
}

}  // namespace millpose::config
