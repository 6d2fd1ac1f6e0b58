// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a cell's `external_axes:` and of a job's `external:`, one line each.
#include "base/error.hpp"
#include "job/config/fields.hpp"

namespace millpose::config {
namespace {

using Axis = ExternalAxisSettings;

const Unit kMicrometre{"µm", 1, 1000};
const Unit kMmPerS{"mm/s", 1, 1}, kMmPerS2{"mm/s²", 1, 1}, kNPerMm{"N/mm", 1, 1};

std::function<bool(const Axis&)> Is(AxisKind kind) {
  return [kind](const Axis& axis) { return axis.kind == kind; };
}

Field<Axis> LimitsOf(const char* key, AxisKind kind, const Unit& unit, const Range& range) {
  return KeyBy<Axis, std::vector<double>>(
             key,
             [](const Axis& axis) {
               return std::vector<double>{axis.lower, axis.upper};
             },
             [](Axis& axis, const std::vector<double>& limits) {
               if (limits.size() == 2) axis.lower = limits[0], axis.upper = limits[1];
             },
             ListOf(Real(unit, range)), "Its least and greatest value.")
      .WhenSet(Is(kind));
}

/// A number of one kind of axis.
template <class Access>
Field<Axis> NumberOf(const char* key, Access access, AxisKind kind, Codec<double> number, const char* doc) {
  return Key<Axis>(key, access, std::move(number), doc).WhenSet(Is(kind));
}

template <class Access>
Field<Axis> StiffnessOf(const char* key, Access access, AxisKind kind, const Unit& unit) {
  return Key<Axis>(key, access, Maybe(Real(unit, Positive(1e12))),
                   "How stiff it is against what it carries while it stands; missing: taken as rigid.")
      .WhenSet([kind](const Axis& axis) { return axis.kind == kind && axis.stiffness; })
      .DefaultText("rigid");
}

template <class Access>
Field<Axis> LostMotionOf(const char* key, Access access, AxisKind kind, const Unit& unit, double most) {
  return Key<Axis>(
             key, access, Maybe(Real(unit, UpTo(most))),
             "How far its drive goes while what it carries stands, from one flank to the other; missing: "
             "not known (docs/lost-motion.md).")
      .WhenSet([kind](const Axis& axis) { return axis.kind == kind && axis.lost_motion; })
      .DefaultText("not known");
}

/// What of an axis has one unit or the other: without and with what follows the name.
struct OfKind {
  const char *linear, *rotary;
  bool required;
};
constexpr OfKind kOfKind[] = {{"limits_mm", "limits_deg", true},
                              {"home_mm", "home_deg", false},
                              {"speed_mm_s", "speed_deg_s", true},
                              {"acceleration_mm_s2", "acceleration_deg_s2", true},
                              {"stiffness_N_mm", "stiffness_Nm_per_rad", false},
                              {"lost_motion_um", "lost_motion_arcmin", false}};

void CheckKeysOfKind(const Value& value, const Context& context, const Axis& axis) {
  const bool linear = axis.kind == AxisKind::kLinear;
  for (const OfKind& key : kOfKind) {
    const char *own = linear ? key.linear : key.rotary, *other = linear ? key.rotary : key.linear;
    if (const Value::Key* given = value.FindKey(other))
      context.Child(other).Add(given->mark, fmt::format("has no effect here: kind is {}; allowed: {}",
                                                        WordOf(kAxisKindWords, axis.kind), own));
    if (key.required && !value.FindKey(own))
      context.Child(own).Add(
          value.mark, fmt::format("missing; required where kind is {}", WordOf(kAxisKindWords, axis.kind)));
  }
  const Value::Key* origin = value.FindKey("origin_mm");
  if (origin && linear)
    context.Child("origin_mm").Add(origin->mark, "has no effect here: a linear axis has no place");
  if (!origin && !linear)
    context.Child("origin_mm").Add(value.mark, "missing; required where kind is rotary");
}

void CheckAxis(const Value& value, const Context& context, Axis& axis) {
  CheckKeysOfKind(value, context, axis);
  const bool linear = axis.kind == AxisKind::kLinear;
  const char* key = linear ? "limits_mm" : "limits_deg";
  const Value* limits = value.Find(key);
  if (limits && (limits->items.size() != 2 || axis.lower >= axis.upper))
    context.Child(key).Add(limits->mark, "given no range; allowed: two numbers, the lesser first");
  else if (limits && (axis.home < axis.lower || axis.home > axis.upper))
    context.Child(linear ? "home_mm" : "home_deg")
        .Add(value.mark,
             fmt::format("given {:g}; allowed: within {}", linear ? axis.home : RadToDeg(axis.home), key));
  const Value::Key* source = value.FindKey("stiffness_source");
  if (axis.stiffness && !source)
    context.Child("stiffness_source")
        .Add(value.mark, "missing; required with a stiffness: where it comes from");
  if (!axis.stiffness && source)
    context.Child("stiffness_source").Add(source->mark, "has no effect here: there is no stiffness");
  if (axis.stiffness) axis.compliance = 1 / *axis.stiffness;
  const char *own = linear ? "lost_motion_um" : "lost_motion_arcmin",
             *other = linear ? "lost_motion_arcmin" : "lost_motion_um";  // refused above
  CheckLostMotionSource(value, context, value.FindKey(other) ? other : own, axis.lost_motion_source);
}

}  // namespace

Codec<ExternalAxisSettings> ExternalAxisFields() {
  using S = ExternalAxisSettings;
  constexpr AxisKind kLine = AxisKind::kLinear, kTurn = AxisKind::kRotary;
  const Range length = Between(-1e6, 1e6), angle = Between(-36000, 36000);
  return Section<S>(
      {
          Key<S>("name", MILLPOSE_AT(name), Text(), "Name, as jobs, bodies and findings call it.").Required(),
          Key<S>("kind", MILLPOSE_AT(kind), ChoiceOf(kAxisKindWords), "How it moves.").Required(),
          Key<S>("carries", MILLPOSE_AT(carries), ChoiceOf(kCarriesWords),
                 "What it moves. Of several that carry the same, each carries those after it.")
              .Required(),
          Key<S>("axis", MILLPOSE_AT(direction), Direction(),
                 "Its direction in the world, with all external axes at 0.")
              .Required(),
          Key<S>("origin_mm", MILLPOSE_AT(origin), Numbers3(kMm, Between(-1e6, 1e6)),
                 "Only of a rotary axis and needed there: a place on it, likewise.")
              .WhenSet(Is(kTurn)),
          LimitsOf("limits_mm", kLine, kMm, length),
          LimitsOf("limits_deg", kTurn, kDeg, angle),
          NumberOf("home_mm", MILLPOSE_AT(home), kLine, Real(kMm, length),
                   "Where it stands when programs start and end.")
              .DefaultText("0"),
          NumberOf("home_deg", MILLPOSE_AT(home), kTurn, Real(kDeg, angle), "Likewise.").DefaultText("0"),
          NumberOf("speed_mm_s", MILLPOSE_AT(speed), kLine, Real(kMmPerS, Positive(1e5)), "Largest speed."),
          NumberOf("speed_deg_s", MILLPOSE_AT(speed), kTurn, Real(kDegPerS, Positive(3600)), "Likewise."),
          NumberOf("acceleration_mm_s2", MILLPOSE_AT(acceleration), kLine, Real(kMmPerS2, Positive(1e6)),
                   "Largest acceleration."),
          NumberOf("acceleration_deg_s2", MILLPOSE_AT(acceleration), kTurn, Real(kDegPerS2, Positive(1e5)),
                   "Likewise."),
          StiffnessOf("stiffness_N_mm", MILLPOSE_AT(stiffness), kLine, kNPerMm),
          StiffnessOf("stiffness_Nm_per_rad", MILLPOSE_AT(stiffness), kTurn, kNmPerRad),
          Key<S>("stiffness_source", MILLPOSE_AT(stiffness_source), Lines(),
                 "Where the stiffness comes from.")
              .WhenSet([](const S& s) { return s.stiffness.has_value(); }),
          LostMotionOf("lost_motion_um", MILLPOSE_AT(lost_motion), kLine, kMicrometre, 1e4),
          LostMotionOf("lost_motion_arcmin", MILLPOSE_AT(lost_motion), kTurn, kArcmin, 60),
          Key<S>("lost_motion_source", MILLPOSE_AT(lost_motion_source), Lines(),
                 "Where the lost motion comes from; needed with it.")
              .WhenSet([](const S& s) { return s.lost_motion.has_value(); }),
      },
      CheckAxis);
}

void CheckExternalAxes(const Value& value, const Context& context, const CellSettings& cell) {
  const std::vector<ExternalAxisSettings>& axes = cell.external_axes;
  const Value* list = value.Find("external_axes");
  if (list && axes.size() > kMostExternalAxes)
    context.Child("external_axes")
        .Add(list->mark, fmt::format("given {}; allowed: up to {}", axes.size(), kMostExternalAxes));
  std::vector<std::string> names;
  for (size_t i = 0; i < axes.size(); ++i) {
    if (std::ranges::find(names, axes[i].name) != names.end())
      context.Child("external_axes")
          .Child(i)
          .Child("name")
          .Add(list->items[i].mark, fmt::format("given {} twice", axes[i].name));
    names.push_back(axes[i].name);
  }
  for (const auto& [controller, options] : cell.controllers)
    for (const ControllerAxis& axis : options.shared.controller_axes) {
      if (axis.axis.empty() || std::ranges::find(names, axis.axis) != names.end()) continue;
      const std::string nearest = NearestName(axis.axis, names);
      context.Child("controllers")
          .Child(controller)
          .Child("external_axes")
          .Add(yaml::Mark{options.shared.controller_axes_line, 0},
               fmt::format("{}: given axis '{}'; allowed: the name of one of external_axes{}", axis.name,
                           axis.axis, nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest)));
    }
  for (size_t i = 0; i < cell.bodies.size(); ++i) {
    const BodySettings& body = cell.bodies[i];
    const Value& given = value.Find("bodies")->items[i];
    const Context at = context.Child("bodies").Child(i).Child("axis");
    const bool carriage = body.mount.mount == Mount::kCarriage;
    if (!carriage && !body.axis.empty())
      at.Add(given.FindKey("axis")->mark, "has no effect here: mount is not carriage");
    if (!carriage || std::ranges::find(names, body.axis) != names.end()) continue;
    const std::string nearest = NearestName(body.axis, names);
    at.Add(given.mark, fmt::format("given '{}'; allowed: the name of one of external_axes{}", body.axis,
                                   nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest)));
  }
}

namespace {

void CheckExternal(const Value& value, const Context& context, ExternalSettings& external) {
  const auto refuse = [&](const char* key, const char* why) {
    if (const Value::Key* given = value.FindKey(key)) context.Child(key).Add(given->mark, why);
  };
  if (external.scope != ExternalScope::kConstant)
    for (const char* key : {"at_mm", "at_deg"})
      if (const Value::Key* given = value.FindKey(key))
        context.Child(key).Add(given->mark,
                               fmt::format("has no effect here: with scope {} the planner chooses",
                                           WordOf(kExternalScopeWords, external.scope)));
  if (external.at_mm || external.at_deg)
    for (const char* key : {"step_mm", "step_deg"}) refuse(key, "has no effect here: the position is given");
  using Units = std::pair<const char*, const char*>;
  for (const auto& [one, other] : {Units("at_mm", "at_deg"), Units("step_mm", "step_deg")})
    if (value.FindKey(one)) refuse(other, "given beside the other unit; allowed: that of the axis");
}

}  // namespace

Codec<ExternalSettings> ExternalFields() {
  using S = ExternalSettings;
  const Range length = Between(-1e6, 1e6), angle = Between(-36000, 36000);
  return Section<S>(
      {
          Key<S>("axis", MILLPOSE_AT(axis), Text(), "Name of one of the cell's `external_axes`.").Required(),
          Key<S>("scope", MILLPOSE_AT(scope), ChoiceOf(kExternalScopeWords),
                 "constant: one position for the whole job; per_pass: one for each pass, which the planner "
                 "chooses; continuous: it may also move evenly along a pass, from one position to another. A "
                 "moving axis adds its own error to the cut, so that nothing moves unless asked for.")
              .Required(),
          Key<S>("at_mm", MILLPOSE_AT(at_mm), Maybe(Real(kMm, length)),
                 "With scope constant, of a linear axis: where it stands.")
              .DefaultText("the planner chooses"),
          Key<S>("at_deg", MILLPOSE_AT(at_deg), Maybe(Real(kDeg, angle)), "Likewise of a rotary axis.")
              .DefaultText("the planner chooses"),
          Key<S>("step_mm", MILLPOSE_AT(step_mm), Maybe(Real(kMm, Positive(1e5))),
                 "Of a linear axis: the greatest distance of the positions that the planner chooses from.")
              .DefaultText("an eighth of its range"),
          Key<S>("step_deg", MILLPOSE_AT(step_deg), Maybe(Real(kDeg, Positive(3600))),
                 "Likewise of a rotary axis.")
              .DefaultText("30"),
      },
      CheckExternal);
}

}  // namespace millpose::config
