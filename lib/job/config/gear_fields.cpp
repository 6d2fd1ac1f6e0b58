// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a cell's `arm:` that its gears have, and what is wrong with them.
#include "job/config/fields.hpp"
#include "machine/robot/axis_convention.hpp"

namespace millpose {

Matrix6 GearMatrix(const ArmSettings& arm) {
  Matrix6 matrix = Matrix6::Identity();
  for (const GearCoupling& coupling : arm.gear_couplings)
    matrix(coupling.gear - 1, coupling.axis - 1) = coupling.factor;
  return matrix;
}

namespace config {
namespace {

const Unit kGearTorque{"N·m", 1000, 1};

Codec<GearCoupling> CouplingFields() {
  using S = GearCoupling;
  return Section<S>(
      {
          Key<S>("gear", MILLPOSE_AT(gear), Integer(1, 6), "The axis whose gear it is, 1 to 6.").Required(),
          Key<S>("axis", MILLPOSE_AT(axis), Integer(1, 6), "Another axis, with which it turns too.")
              .Required(),
          Key<S>("factor", MILLPOSE_AT(factor), Real(kOne, Between(-10, 10)),
                 "By how much of that axis's angle, in the arm's own signs.")
              .Required(),
      },
      [](const Value& value, const Context& context, S& coupling) {
        if (coupling.gear == coupling.axis)
          context.Child("axis").Add(
              value.Find("axis")->mark,
              fmt::format("given {0}, the gear's own; allowed: another", coupling.axis));
        if (coupling.factor == 0)
          context.Child("factor").Add(value.Find("factor")->mark, "given 0, which has no effect");
      });
}

Codec<GearErrorSettings> GearErrorFields() {
  using S = GearErrorSettings;
  return Section<S>({
      Key<S>("amplitude_arcsec", MILLPOSE_AT(amplitude), Numbers6(kArcsec, UpTo(3600)),
             "Of each joint's gear, from the mean to the largest.")
          .Required(),
      Key<S>("periods_per_turn", MILLPOSE_AT(periods), Numbers6(kOne, Between(0.1, 10000)),
             "In one turn of the joint; of most gears once or twice in one of the motor: the ratio or its "
             "double.")
          .Required(),
      Key<S>("source", MILLPOSE_AT(source), Lines(),
             "Where these come from. Begins with `assumed` where nobody has measured them.")
          .Required(),
  });
}

}  // namespace

const Unit kArcmin{"arcmin", kRadPerDeg, 60};
const Unit kArcsec{"arcsec", kRadPerDeg, 3600};

std::vector<Field<ArmSettings>> WithGears(std::vector<Field<ArmSettings>> fields) {
  using S = ArmSettings;
  const auto known = [](const S& s) { return s.lost_motion.has_value(); };
  fields.push_back(
      Key<S>("lost_motion_arcmin", MILLPOSE_AT(lost_motion), Maybe(Numbers6(kArcmin, UpTo(60))),
             "How far the input of each joint's gear turns while its output stands, from one flank to the "
             "other; 0: a joint without a gap. Missing: not known, and reversals are only counted "
             "(docs/lost-motion.md).")
          .WhenSet(known)
          .DefaultText("not known"));
  fields.push_back(Key<S>("lost_motion_source", MILLPOSE_AT(lost_motion_source), Lines(),
                          "Where the lost motion comes from; needed with it. Begins with `assumed` where "
                          "nobody has measured it.")
                       .WhenSet(known));
  fields.push_back(
      Key<S>("gear_error", MILLPOSE_AT(gear_error), Maybe(GearErrorFields()),
             "Periodic error of the gears, of unknown phase: it counts in the budget and in the faces that "
             "`millpose face` draws. Of gears in `deviations.gears`: what the table leaves.")
          .WhenSet([](const S& s) { return s.gear_error.has_value(); })
          .DefaultText("not known"));
  fields.push_back(
      Key<S>("gear_friction_Nm", MILLPOSE_AT(gear_friction), Maybe(Numbers6(kGearTorque, UpTo(1e6))),
             "Torques about the joints up to which friction alone says on which flank a gear rests; above, "
             "weight and cutting force do. With `stiffness.gravity` only. Missing: load is not looked at.")
          .WhenSet([](const S& s) { return s.gear_friction.has_value(); })
          .DefaultText("load is not looked at"));
  fields.push_back(Key<S>("gear_couplings", MILLPOSE_AT(gear_couplings), ListOf(CouplingFields()),
                          "Gears that turn with other axes too: of an arm with a parallelogram the third by "
                          "A2 + A3, {gear: 3, axis: 2, factor: 1}.")
                       .WhenSet([](const S& s) { return !s.gear_couplings.empty(); })
                       .DefaultText("none"));
  return fields;
}

void CheckGears(const Value& value, const Context& context, const ArmSettings& arm) {
  CheckLostMotionSource(value, context, "lost_motion_arcmin", arm.lost_motion_source);
  const Value* couplings = value.Find("gear_couplings");
  for (size_t i = 0; i < arm.gear_couplings.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (arm.gear_couplings[i].gear == arm.gear_couplings[j].gear &&
          arm.gear_couplings[i].axis == arm.gear_couplings[j].axis)
        context.Child("gear_couplings")
            .Child(i)
            .Add(couplings->items[i].mark,
                 fmt::format("given gear {} with axis {} twice", arm.gear_couplings[i].gear,
                             arm.gear_couplings[i].axis));
  try {
    AxisConvention(GearMatrix(arm), Joints::Zero());
  } catch (const std::invalid_argument&) {
    context.Child("gear_couplings")
        .Add(couplings->mark, "given couplings that leave axes without a gear of their own");
  }
}

void CheckLostMotionSource(const Value& value, const Context& context, const char* key,
                           const std::string& source) {
  const bool known = value.FindKey(key) != nullptr;
  const Value::Key* given = value.FindKey("lost_motion_source");
  const Context at = context.Child("lost_motion_source");
  if (known && source.empty())
    at.Add(value.FindKey(key)->mark, fmt::format("missing; required with {}: where it comes from", key));
  if (!known && given) at.Add(given->mark, fmt::format("has no effect here: {} is missing", key));
}

void CheckGearFriction(const Value& value, const Context& context, const CellSettings& cell) {
  if (!cell.arm.gear_friction || cell.gravity) return;
  context.Child("arm")
      .Child("gear_friction_Nm")
      .Add(value.Find("arm")->FindKey("gear_friction_Nm")->mark,
           "has no effect here: the cell says no weights; allowed: with stiffness.gravity");
}

}  // namespace config
}  // namespace millpose
