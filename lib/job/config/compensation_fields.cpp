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
  if (const Value::Key* found = value.FindKey("max_mm"); found && !s.Shifts())
    context.Child("max_mm").Add(found->mark, "has no effect here: nothing is compensated");
}

// What only deviations follow, also where nothing else is taken out.
void CheckDeviationKeys(const Value& value, const Context& context, CompensationSettings& s) {
  CheckEffect(value, context, s);
  if (s.deviations) return;
  for (const char* key : {"max_deviation_mm", "max_gear_mm"})
    if (const Value::Key* found = value.FindKey(key))
      context.Child(key).Add(found->mark, "has no effect here: compensation.deviations is false");
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
              .WhenSet([](const S& s) { return s.Shifts(); })
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
          Key<S>(
              "deviations", MILLPOSE_AT(deviations), Flag(),
              "Commands poses such that the arm as it is, with `arm.deviations` of the cell, goes where the "
              "plan has the tool: for that one arm (docs/arm-deviations.md).")
              .WhenSet([](const S& s) { return s.deviations; })
              .DefaultText("false"),
          Key<S>("max_deviation_mm", MILLPOSE_AT(most_deviation), Real(kMm, Positive(50)),
                 "Most that the arm's deviations may move the tip by: more is taken for wrong values.")
              .WhenSet([](const S& s) { return s.deviations; })
              .DefaultText("5"),
          Key<S>("max_gear_mm", MILLPOSE_AT(most_gear), Real(kMm, Positive(10)),
                 "Likewise what its gears' tables and couplings may.")
              .WhenSet([](const S& s) { return s.deviations && s.most_gear != 2; })
              .DefaultText("2"),
      },
      CheckDeviationKeys);
}

}  // namespace millpose::config
