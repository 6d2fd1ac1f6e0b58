// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of `controllers.krl` in a cell, and KRL's line in the registry.
#include "program/krl/krl.hpp"
#include "program/post_entry.hpp"

namespace millpose {
namespace {

using namespace yaml;  // NOLINT: tables are written in its words
using S = KrlOptions;

Codec<KrlRail> RailFields() {
  using R = KrlRail;
  return Section<R>({
      Key<R>("pose", MILLPOSE_AT(pose), PoseFields(), "$ERSYSROOT: the rail's root in $WORLD.").Required(),
      Key<R>("direction", MILLPOSE_AT(direction), ChoiceOf(kFrameAxisWords),
             "Direction of $ERSYSROOT in which the carriage moves where its axis grows."),
  });
}

Codec<KrlTable> TableFields() {
  using T = KrlTable;
  return Section<T>({
      Key<T>("machine_def", MILLPOSE_AT(machine_def), Integer(2, 16),
             "Number n of the kinematic in MACHINE_DEF.")
          .Required(),
      Key<T>("root", MILLPOSE_AT(root), PoseFields(), "MACHINE_DEF[n].ROOT: its root in $WORLD.").Required(),
      Key<T>("flange", MILLPOSE_AT(flange), PoseFields(),
             "The frame that the kinematic carries, in its root with its axes at 0."),
  });
}

std::vector<Field<S>> FrameAndSpeedKeys() {
  return {
      Key<S>("base_number", MILLPOSE_AT(base_number), Integer(0, 32),
             "$BASE = BASE_DATA[number] instead of values; 0: values."),
      Key<S>("tool_number", MILLPOSE_AT(tool_number), Integer(0, 16),
             "$TOOL = TOOL_DATA[number] instead of values; 0: values."),
      Key<S>("ptp_speed_percent", MILLPOSE_AT(ptp_speed_percent), Integer(1, 100),
             "Share of the axes' largest speed in motions between cuts."),
      Key<S>(
          "tool_in_spindle", MILLPOSE_AT(tool_in_spindle), Text(),
          "Global INT variable of the plant that holds the number of the tool in the spindle: programs that "
          "change the tool wait until it is the right one.")
          .WhenSet([](const S& s) { return !s.tool_in_spindle.empty(); }),
      Key<S>("advance", MILLPOSE_AT(advance), Integer(1, 5), "$ADVANCE, motions computed ahead."),
  };
}

std::vector<Field<S>> ToolAndRobotKeys() {
  return {
      Key<S>("orientation_speed_deg_s", MILLPOSE_AT(orientation_speed), Real(kDegPerS, Positive(3600)),
             "$VEL.ORI1 and $VEL.ORI2."),
      Key<S>("orientation_acceleration_deg_s2", MILLPOSE_AT(orientation_acceleration),
             Maybe(Real(kDegPerS2, Positive(1e5))),
             "$ACC.ORI1 and $ACC.ORI2; the controller's own by default."),
      Key<S>("tool_direction", MILLPOSE_AT(tool_direction),
             ChoiceOf<FrameAxis>({{"x", FrameAxis::kX}, {"y", FrameAxis::kY}, {"z", FrameAxis::kZ}}),
             "$TOOL_DIRECTION, the axis of $TOOL that LIN swivels evenly."),
      Key<S>("robroot", MILLPOSE_AT(robroot), Maybe(PoseFields()),
             "$ROBROOT, the robot's base in $WORLD, as the controller has it; with ersysroot: the robot's "
             "base on the carriage at 0. Needed where the robot does not stand upright.")
          .DefaultText("zero, as delivered"),
      Key<S>("ersysroot", MILLPOSE_AT(ersysroot), Maybe(RailFields()),
             "A rail that the controller counts in ($WORLD stays where it is when it moves); its carriage is "
             "the "
             "axis of external_axes that is coupled and carries the robot."),
      Key<S>("external_base", MILLPOSE_AT(external_base), Maybe(TableFields()),
             "A table that the controller counts in: $BASE = EK(MACHINE_DEF[n].ROOT, …) moves with it."),
      Key<S>("write_load", MILLPOSE_AT(write_load), Maybe(Flag()),
             "Programs set $LOAD to tool.load; else the controller's own load data hold.")
          .DefaultText("true where tool.load is given and tool_number is not"),
  };
}

void Check(const Value& value, const Context& context, PostSection<S>& section) {
  const S& options = section.own;
  if (options.ersysroot && std::ranges::none_of(section.shared.controller_axes, &ControllerAxis::coupled))
    context.Child("ersysroot")
        .Add(value.FindKey("ersysroot")->mark,
             "none of external_axes is coupled; needed: the one that is the carriage");
  if (!options.tool_in_spindle.empty() && !IsWord(options.tool_in_spindle))
    context.Child("tool_in_spindle")
        .Add(value.FindKey("tool_in_spindle")->mark,
             fmt::format("given '{}'; allowed: letters, digits and '_', at most 31, beginning with a letter",
                         options.tool_in_spindle));
}

}  // namespace

PostEntry KrlEntry() {
  std::vector<PostKey<S>> keys = {ToolAxisKey(), AxisSignsKey(), AxisOffsetsKey(), AxisCouplingsKey()};
  keys.emplace_back(ExternalAxesKey({"E1", "E2", "E3", "E4", "E5", "E6"}, true));
  std::ranges::copy(FrameAndSpeedKeys(), std::back_inserter(keys));
  keys.emplace_back(PathAccelerationKey());
  std::ranges::copy(ToolAndRobotKeys(), std::back_inserter(keys));
  keys.emplace_back(CycleKey(KrlPost().UsualCycle()));
  keys.emplace_back(BlockTimeKey());
  keys.emplace_back(
      Key<S>("program_memory_kbytes", MILLPOSE_AT(memory_kbytes), Integer(100, 10000000),
             "Memory for programs, kB; larger programs are warned of. KRC4 with KSS 8.3: about 4 MB."));
  for (const SharedKey& key : {MaxMotionsKey(), MaxKbytesKey(), OutputsKey(true), TextsKey(), CallsKey()})
    keys.emplace_back(key);
  return EntryOf<KrlPost>(keys, Check);
}

}  // namespace millpose
