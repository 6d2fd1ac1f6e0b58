// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a job's `program_options:`, one line each.
#include "config/fields.hpp"

namespace millpose::config {

Codec<ProgramOptionSettings> ProgramOptionFields() {
  using S = ProgramOptionSettings;
  return Section<S>({
      Key<S>("point_economy", kSelf,
             Section<S>({
                 Key<S>("chord_mm", MILLPOSE_AT(chord_tolerance), Real(kMm, Between(0, 0.015)),
                        "A point is left out where the controller's own motion passes it this near; 0 keeps "
                        "every point."),
                 Key<S>("angle_deg", MILLPOSE_AT(angle_tolerance), Real(kDeg, Between(0, 0.02)),
                        "Likewise for the tool's orientation."),
                 Key<S>("spacing_mm", MILLPOSE_AT(spacing), Real(kMm, UpTo(1000)),
                        "Least distance of points, where the tolerances allow it; nearer ones are counted."),
             }),
             "Points that the controller's own interpolation makes needless are left out."),
      Key<S>("dry_run_offset_mm", MILLPOSE_AT(dry_run_offset), Real(kMm, UpTo(1000)),
             "Lifts every cut along the tool axis, to see the program run in the air."),
      Key<S>("base_window", kSelf,
             Section<S>({
                 Key<S>("shift_mm", MILLPOSE_AT(base_shift), Real(kMm, UpTo(1000)), "Along X, Y and Z."),
                 Key<S>("turn_deg", MILLPOSE_AT(base_turn), Real(kDeg, Between(0, 5)), "About X, Y and Z."),
             }),
             "With workpiece.targets: how far $BASE may be shifted; reach and clearance are re-verified for "
             "it."),
      Key<S>("date", MILLPOSE_AT(date), Text(), "Printed in the programs' headers; none by default.")
          .WhenSet([](const S& s) { return !s.date.empty(); }),
  });
}

}  // namespace millpose::config
