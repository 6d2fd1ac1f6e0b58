// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a job's `compensation:`, one line each.
#include "job/config/fields.hpp"

namespace millpose::config {
namespace {

// Keys that only the deflection under the cutting force follows.
void CheckEffect(const Value& value, const Context& context, CompensationSettings& s) {
  if (s.deflection != TakeOut::kOff) return;
  for (const char* key : {"shrink", "stiffness_uncertainty_percent", "layers"})
    if (const Value::Key* found = value.FindKey(key))
      context.Child(key).Add(found->mark, "has no effect here: compensation.deflection is off");
  if (const Value::Key* found = value.FindKey("max_mm"); found && !s.IsOn())
    context.Child("max_mm").Add(found->mark, "has no effect here: nothing is compensated");
}

}  // namespace

Codec<CompensationSettings> CompensationFields() {
  using S = CompensationSettings;
  const auto force = [](const S& s) { return s.deflection != TakeOut::kOff; };
  return Section<S>(
      {
          Key<S>("deflection", MILLPOSE_AT(deflection), ChoiceOf(kTakeOutWords),
                 "What of the deflection under the cutting force is taken out: its part along the surface "
                 "normal, or that across the feed as well (walls)."),
          Key<S>("shrink", MILLPOSE_AT(shrink), AutoOr(Real(kOne, Between(0, 1))),
                 "Share of the expected deflection that is taken out; auto: at each point the one that makes "
                 "the worst that may remain least and can make nothing worse.")
              .WhenSet(force)
              .DefaultText("auto"),
          Key<S>("stiffness_uncertainty_percent", MILLPOSE_AT(stiffness_uncertainty),
                 Maybe(Real(kPercent, Between(0, 90))),
                 "By how much each stiffness may differ from the cell's.")
              .WhenSet(force)
              .DefaultText("the cell's, where arm.stiffness_uncertainty_percent says it; else 10"),
          Key<S>("max_mm", MILLPOSE_AT(most), Real(kMm, Positive(2)), "Largest shift of any point.")
              .WhenSet([](const S& s) { return s.IsOn(); })
              .DefaultText("0.1"),
          Key<S>("layers", MILLPOSE_AT(layers), ChoiceOf(kCompensatedLayersWords),
                 "Whether layers above the finished one are compensated too.")
              .WhenSet(force)
              .DefaultText("finished"),
          Key<S>("weight", MILLPOSE_AT(weight), Flag(),
                 "Takes out what the arm's own weight bends, as `stiffness.gravity` of the cell says."),
          Key<S>(
              "map_csv", MILLPOSE_AT(map_file), Text(),
              "Map of a measured part's error, which `millpose calibrate --map` writes, taken out along the "
              "normal; relative to the job file (docs/error-map.md).")
              .WhenSet([](const S& s) { return !s.map_file.empty(); }),
      },
      CheckEffect);
}

}  // namespace millpose::config
