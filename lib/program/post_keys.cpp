// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/post_keys.hpp"

#include <set>

namespace millpose {
namespace {

using namespace yaml;  // NOLINT: tables are written in its words
using S = PostOptions;

const Unit kMillisecond{"ms", 1, 1000};
const Unit kMetrePerS2{"m/s²", 1000, 1};

Codec<PathOutput> OutputFields(bool delay) {
  std::vector<Field<PathOutput>> fields = {
      Key<PathOutput>("number", MILLPOSE_AT(number), Integer(0, 8192), "Number of the digital output.")
          .Required(),
      Key<PathOutput>("at", MILLPOSE_AT(at_begin), ChoiceOf<bool>({{"cut_begin", true}, {"cut_end", false}}),
                      "First or last point of every cut (lead-in and lead-out belong to it).")
          .Required(),
      Key<PathOutput>("set", MILLPOSE_AT(on), Flag(), "What it is switched to.").Required()};
  if (delay)
    fields.push_back(Key<PathOutput>("delay_ms", MILLPOSE_AT(delay), Real(kMillisecond, Between(-1000, 1000)),
                                     "Later than at that place; negative: before.")
                         .WhenSet([](const PathOutput& output) { return output.delay != 0; }));
  return Section<PathOutput>(std::move(fields));
}

/// Where a call that moves begins or ends.
Field<DeclaredCall> PlaceKey(const char* key, Joints DeclaredCall::*place, const char* doc) {
  return KeyBy<DeclaredCall, std::optional<Joints>>(
      key,
      [place](const DeclaredCall& call) { return call.moves ? std::optional(call.*place) : std::nullopt; },
      [place](DeclaredCall& call, const std::optional<Joints>& given) { call.*place = *given; },
      Maybe(Numbers6(kDeg, Between(-3600, 3600))), doc);
}

Codec<DeclaredCall> CallFields() {
  using Call = DeclaredCall;
  return Section<Call>(
      {
          Key<Call>("name", MILLPOSE_AT(name), Text(), "Name of the program (LinuxCNC: or M100 to M199).")
              .Required(),
          Key<Call>("moves", MILLPOSE_AT(moves), Flag(), "Whether it moves the arm.").Required(),
          PlaceKey("from_deg", &Call::from, "Axes A1 to A6 (as home_deg) at which a call that moves begins."),
          PlaceKey("to_deg", &Call::to, "Axes A1 to A6 at which a call that moves ends."),
      },
      [](const Value& value, const Context& context, Call& call) {
        if (!IsWord(call.name))
          context.Child("name").Add(value.mark,
                                    fmt::format("given '{}'; allowed: letters, digits and '_', at most 31, "
                                                "beginning with a letter",
                                                call.name));
        const bool from = value.Find("from_deg") != nullptr, to = value.Find("to_deg") != nullptr;
        if (call.moves != (from && to) || call.moves != (from || to))
          context.Add(value.mark, call.moves ? "a call that moves needs from_deg and to_deg"
                                             : "from_deg and to_deg have no effect where moves is false");
      });
}

/// Where an axis stands that the cell does not plan.
Field<ControllerAxis> ConstantKey(const char* key, AxisKind kind, const Unit& unit, const char* doc) {
  using A = ControllerAxis;
  return KeyBy<A, std::optional<double>>(
      key,
      [kind](const A& axis) {
        return axis.axis.empty() && !axis.name.empty() && axis.kind == kind ? std::optional(axis.constant)
                                                                            : std::nullopt;
      },
      [kind](A& axis, const std::optional<double>& given) {
        axis.kind = kind;
        axis.constant = *given;
      },
      Maybe(Real(unit, Between(-1e6, 1e6))), doc);
}

Codec<ControllerAxis> ControllerAxisFields(const std::vector<std::string>& names, bool still) {
  using A = ControllerAxis;
  static const Unit degrees{"deg", 1, 1};  // as the program says it
  std::vector<Field<A>> fields = {
      Key<A>("name", MILLPOSE_AT(name), names.empty() ? Text() : Choice(names), "By which programs name it.")
          .Required(),
      Key<A>("axis", MILLPOSE_AT(axis), Text(), "Which of the cell's external_axes it is.")
          .WhenSet([](const A& axis) { return !axis.axis.empty(); }),
      Key<A>("coupled", MILLPOSE_AT(coupled), Flag(),
             "Whether the controller counts in it: its poses stay where they are when the axis moves.")
          .WhenSet([](const A& axis) { return !axis.axis.empty() || axis.coupled; })};
  if (still) {
    fields.push_back(
        ConstantKey("constant_mm", AxisKind::kLinear, kMm, "Where it stands, if the cell does not have it."));
    fields.push_back(ConstantKey("constant_deg", AxisKind::kRotary, degrees, "The same of a rotary axis."));
  }
  return Section<A>(std::move(fields), [names, still](const Value& value, const Context& context, A& axis) {
    const int given = int{value.Find("axis") != nullptr} + int{value.Find("constant_mm") != nullptr} +
                      int{value.Find("constant_deg") != nullptr};
    if (still ? given != 1 : value.Find("axis") == nullptr)
      context.Add(value.mark,
                  still ? fmt::format("given {} of axis, constant_mm and constant_deg; allowed: one", given)
                        : "axis is missing; required: one of the cell's external_axes");
    if (!axis.axis.empty() && value.Find("coupled") == nullptr)
      context.Child("coupled").Add(value.mark, "missing; required with axis: true or false");
    if (names.empty() && !IsWord(axis.name))
      context.Child("name").Add(value.mark,
                                fmt::format("given '{}'; allowed: letters, digits and '_'", axis.name));
  });
}

/// From counts without couplings to those with them; no unit.
Matrix6 Coupled(const std::vector<AxisCoupling>& couplings) {
  Matrix6 matrix = Matrix6::Identity();
  for (const AxisCoupling& coupling : couplings)
    matrix.row(coupling.axis - 1) += coupling.factors.transpose();
  return matrix;
}

Codec<AxisCoupling> CouplingFields() {
  using C = AxisCoupling;
  return Section<C>(
      {Key<C>("axis", MILLPOSE_AT(axis), Integer(1, 6), "Which axis counts more than itself.").Required(),
       Key<C>("factors", MILLPOSE_AT(factors), Numbers6(kOne, Between(-10, 10)),
              "Of the controller's six axes; 0 for the axis itself.")
           .Required()},
      [](const Value& value, const Context& context, C& coupling) {
        const auto own = static_cast<size_t>(coupling.axis - 1);
        const Value& factors = value.Find("factors")->items[own];
        if (coupling.factors[coupling.axis - 1] != 0)
          context.Child("factors").Child(own).Add(
              factors.mark, fmt::format("given {}; allowed: 0, as axis {} counts itself once (axis_signs)",
                                        factors.text, coupling.axis));
        if (coupling.factors.isZero(0.0))
          context.Child("factors").Add(
              value.Find("factors")->mark,
              "given 0 six times, which has no effect; allowed: a factor that is not 0");
      });
}

/// Each axis once, and what can be undone.
void CheckCouplings(const Value& list, const Context& context, const std::vector<AxisCoupling>& couplings) {
  std::set<int> axes;
  for (size_t i = 0; i < couplings.size(); ++i)
    if (!axes.insert(couplings[i].axis).second)
      context.Child(i).Child("axis").Add(list.items[i].Find("axis")->mark,
                                         fmt::format("given {} twice; allowed: once", couplings[i].axis));
  try {
    AxisConvention(Coupled(couplings), Joints::Zero());
  } catch (const std::invalid_argument&) {
    context.Add(list.mark, "given couplings that cannot be undone: different angles would be counted alike");
  }
}

/// No name stands twice.
void CheckAxes(const Value& list, const Context& context) {
  std::set<std::string> names;
  for (size_t i = 0; i < list.items.size(); ++i) {
    const Value* name = list.items[i].Find("name");
    if (name != nullptr && !names.insert(name->text).second)
      context.Child(i).Child("name").Add(name->mark,
                                         fmt::format("given '{}' twice; allowed: once", name->text));
  }
}

/// Programs are ASCII: what a text puts into them must be so too.
void CheckAscii(const Value& texts, const Context& context) {
  for (size_t i = 0; i < texts.items.size(); ++i) {
    const std::string& text = texts.items[i].text;
    const auto odd = std::ranges::find_if(text, [](char c) { return c != '\n' && (c < ' ' || c > '~'); });
    if (odd == text.end()) continue;
    context.Child(texts.keys[i].text)
        .Add(texts.items[i].mark, "programs are plain ASCII: letters, digits, blanks and !…~ allowed");
  }
}

}  // namespace

AxisConvention PostOptions::UncoupledAxes() const {
  std::array<double, 6> signs{1, 1, 1, 1, 1, 1};
  if (axis_signs) std::ranges::copy(*axis_signs, signs.begin());
  return AxisConvention::OfSigns(signs, axis_offsets.value_or(Joints::Zero()));
}

AxisConvention PostOptions::Axes() const {
  return axis_couplings ? AxisConvention(Coupled(*axis_couplings), Joints::Zero()).After(UncoupledAxes())
                        : UncoupledAxes();
}

bool IsWord(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !name.empty() && name.size() <= 31 && letter(name[0]) &&
         std::ranges::all_of(name, [&](char c) { return letter(c) || (c >= '0' && c <= '9'); });
}

SharedKey ToolAxisKey() {
  return Key<S>("tool_axis", MILLPOSE_AT(tool_axis), ChoiceOf(kFrameAxisWords),
                "Axis of the controller's tool frame that lies along the tool, from tip to holder.");
}

SharedKey RotationKey() {
  return Key<S>("rotation", MILLPOSE_AT(rotation), ChoiceOf(kAngleOrderWords),
                "SINUMERIK (machine data ORI), Cartesian LinuxCNC: how A, B, C are counted.");
}

constexpr const char* kAxesDefault =
    "KRL: KUKA's own; RAPID: ABB's; else as the arm counts, needed with arm.urdf";

SharedKey AxisSignsKey() {
  return Key<S>("axis_signs", MILLPOSE_AT(axis_signs), Maybe(Signs()),
                "Controller's angle = sign × arm's angle + offset.")
      .DefaultText(kAxesDefault);
}

SharedKey AxisOffsetsKey() {
  return Key<S>("axis_offsets_deg", MILLPOSE_AT(axis_offsets), Maybe(Numbers6(kDeg, Between(-360, 360))),
                "Controller's angle = sign × arm's angle + offset.")
      .DefaultText(kAxesDefault);
}

SharedKey AxisCouplingsKey() {
  SharedKey key =
      Key<S>("axis_couplings", MILLPOSE_AT(axis_couplings), Maybe(ListOf(CouplingFields())),
             "Axes that the controller counts together, on top of signs and offsets: factors × its counts of "
             "the other axes are added to that of `axis`. FANUC's J3, which stays when J2 moves: [{axis: 3, "
             "factors: [0, -1, 0, 0, 0, 0]}].")
          .DefaultText("none");
  key.read = [read = key.read](const Value& value, const Context& context, S& options) {
    const size_t problems_before = context.problems.size();
    read(value, context, options);
    if (context.problems.size() == problems_before) CheckCouplings(value, context, *options.axis_couplings);
  };
  return key;
}

SharedKey PathAccelerationKey() {
  return Key<S>("path_acceleration_m_s2", MILLPOSE_AT(path_acceleration),
                Maybe(Real(kMetrePerS2, Positive(100))),
                "Largest acceleration of the tip, for the estimate of the speed along the path (2.3 by "
                "default); KRL: also written as $ACC.CP.");
}

SharedKey CycleKey(double usual) {
  return Key<S>("interpolation_cycle_ms", MILLPOSE_AT(cycle), Maybe(Real(kMillisecond, Between(0.1, 100))),
                "Interpolation cycle, for the estimate of the speed along the path.")
      .DefaultText(ShortestIn(kMillisecond, usual));
}

SharedKey BlockTimeKey() {
  return Key<S>("block_time_ms", MILLPOSE_AT(block_time), Maybe(Real(kMillisecond, Between(0.1, 1000))),
                "Shortest time per motion, for that estimate.")
      .DefaultText("the interpolation cycle");
}

SharedKey MaxCornerKey() {
  return Key<S>("max_corner_mm", MILLPOSE_AT(max_corner), Maybe(Real(kMm, Positive(10))),
                "By how much a rounded corner, whose path the maker does not document, may leave the "
                "programmed one under the assumption that programs state; without it, or beyond it, programs "
                "are withheld. At most interference.swept_resolution_mm.");
}

SharedKey MaxMotionsKey() {
  return Key<S>("max_motions", MILLPOSE_AT(max_motions), Integer(10, 1000000),
                "Motions in one program file; larger programs call sub-programs.");
}

SharedKey MaxKbytesKey() {
  return Key<S>("max_kbytes", MILLPOSE_AT(max_kbytes), Integer(4, 1000000),
                "Size of one program file, kB; larger programs call sub-programs.");
}

SharedKey ExternalAxesKey(const std::vector<std::string>& names, bool still) {
  SharedKey key =
      Key<S>("external_axes", MILLPOSE_AT(controller_axes), ListOf(ControllerAxisFields(names, still)),
             "The axes beside the arm's six that programs state.")
          .WhenSet([](const S& s) { return !s.controller_axes.empty(); });
  key.read = [read = key.read, still](const Value& value, const Context& context, S& options) {
    const auto number = std::ranges::find(value.items, Value::Kind::kScalar, &Value::kind);
    if (still && number != value.items.end())
      return context.Add(
          number->mark, fmt::format("given {}: is no longer a list of numbers; give {{name: E1, constant_mm: "
                                    "{}}}, or constant_deg of a rotary axis",
                                    number->text, number->text));
    read(value, context, options);
    options.controller_axes_line = value.mark.line;
    CheckAxes(value, context);
  };
  return key;
}

SharedKey OutputsKey(bool delay) {
  return Key<S>("outputs", MILLPOSE_AT(outputs), ListOf(OutputFields(delay)),
                "Digital outputs that are switched on the path, without a stop.");
}

SharedKey TextsKey(const std::vector<std::string>& own) {
  std::vector<std::string> names = {"coolant_off", "coolant_on", "footer",      "header",     "pass_begin",
                                    "pass_end",    "spindle_on", "spindle_off", "tool_change"};
  names.insert(names.end(), own.begin(), own.end());
  std::ranges::sort(names);
  SharedKey key = Key<S>("texts", MILLPOSE_AT(texts), MapOf<std::string>(std::move(names), Lines()),
                         "Template lines by event, in place of the built-in ones; {rpm}, {tool}, {pass}, "
                         "{piece} are filled in.");
  key.read = [read = key.read](const Value& value, const Context& context, S& options) {
    read(value, context, options);
    CheckAscii(value, context);
    for (const Value::Key& name : value.keys) options.text_lines[name.text] = name.mark.line;
  };
  return key;
}

SharedKey CallsKey() {
  return Key<S>("calls", MILLPOSE_AT(calls), ListOf(CallFields()),
                "Programs of the plant that texts may call. What they do to settings counts as unknown.")
      .WhenSet([](const S& s) { return !s.calls.empty(); });
}

}  // namespace millpose
