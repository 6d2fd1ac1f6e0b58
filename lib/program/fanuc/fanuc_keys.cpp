// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of `controllers.fanuc` in a cell, and FANUC's line in the registry.
#include "program/fanuc/fanuc.hpp"
#include "program/post_entry.hpp"

namespace millpose {
namespace {

using namespace yaml;  // NOLINT: tables are written in its words
using S = FanucOptions;

std::vector<Field<S>> FrameKeys() {
  return {
      Key<S>("user_frame", MILLPOSE_AT(user_frame), Integer(1, 61),
             "Number of UFRAME, which holds the workpiece's place.")
          .Required(),
      Key<S>("tool_frame", MILLPOSE_AT(tool_frame), Integer(1, 29), "Number of UTOOL, which holds the tool.")
          .Required(),
      Key<S>("position_register", MILLPOSE_AT(position_register), Integer(0, 2000),
             "PR[n] by which programs set UFRAME and UTOOL; 0: the controller holds the values that heads "
             "state."),
      KeyBy<S, std::optional<double>>(
          "world_height_mm", [](const S& s) { return s.world_height; },
          [](S& s, const std::optional<double>& given) { s.world_height = given; },
          Maybe(Real(kMm, Between(-10000, 10000))),
          "Height of the controller's world origin above the robot's base: that of axis 2, in the data "
          "sheet.")
          .Required(),
  };
}

Codec<std::array<int, 3>> TurnAxes() {
  const Codec<std::vector<int>> list = ListOf(Integer(1, 6));
  Codec<std::array<int, 3>> codec;
  codec.type = "list of 3 axes 1…6, each once";
  codec.schema = [] { return codec_detail::ListSchema(Integer(1, 6).schema(), 3, 3); };
  codec.read = [list, type = codec.type](const Value& value, const Context& context,
                                         std::array<int, 3>& axes) {
    const size_t problems_before = context.problems.size();
    std::vector<int> given;
    list.read(value, context, given);
    if (context.problems.size() != problems_before) return;
    const bool once =
        given.size() == 3 && given[0] != given[1] && given[1] != given[2] && given[0] != given[2];
    if (!once) return context.AddWrong(value, type);
    std::ranges::copy(given, axes.begin());
  };
  codec.write = [list](const std::array<int, 3>& axes) {
    return list.write(std::vector<int>(axes.begin(), axes.end()));
  };
  return codec;
}

const Unit kMillis{"ms", 1, 1000};

std::vector<Field<S>> CornerKeys() {
  return {Key<S>("corner_region", MILLPOSE_AT(corner_region), Flag(),
                 "The controller has CRy (Advanced Constant Path); needs max_corner_mm.")
              .WhenSet([](const S& s) { return s.corner_region; }),
          Key<S>("acceleration_time_ms", MILLPOSE_AT(acceleration_time), Maybe(Real(kMillis, Positive(2000))),
                 "Longest time of a whole ramp at CNTn, which bounds its corners; needs max_corner_mm. "
                 "Without it no "
                 "CNTn is written.")};
}

/// What no cell can leave open: whether J3 counts against the level differs between arms.
void Check(const Value& value, const Context& context, PostSection<S>& section) {
  const bool region = section.own.corner_region, cnt = section.own.acceleration_time.has_value();
  if (region && cnt)
    context.Child("corner_region")
        .Add(value.FindKey("corner_region")->mark,
             "given with acceleration_time_ms; allowed: one of the two");
  if ((region || cnt) && !section.shared.max_corner)
    context.Add(value.mark,
                "max_corner_mm is missing: by how much a corner may leave its path; needed where "
                "corner_region or acceleration_time_ms is given");
  if (!region && !cnt && section.shared.max_corner)
    context.Child("max_corner_mm")
        .Add(value.FindKey("max_corner_mm")->mark,
             "has no effect without corner_region or acceleration_time_ms: corners are passed at CNT0");
  if (!section.shared.axis_couplings)
    context.Add(value.mark,
                "axis_couplings is missing: [{axis: 3, factors: [0, -1, 0, 0, 0, 0]}] where J3 on the "
                "pendant stays when "
                "J2 alone is jogged, [] where it does not; needed (docs/fanuc.md)");
}

}  // namespace

PostEntry FanucEntry() {
  std::vector<PostKey<S>> keys = {ToolAxisKey(), AxisSignsKey(), AxisOffsetsKey(), AxisCouplingsKey()};
  std::ranges::copy(FrameKeys(), std::back_inserter(keys));
  keys.emplace_back(Key<S>("turn_axes", MILLPOSE_AT(turn_axes), TurnAxes(),
                           "The axes whose full turns the numbers of CONFIG count: $SCR_GRP[1].$TURN_AXIS."));
  keys.emplace_back(Key<S>("joint_speed_percent", MILLPOSE_AT(joint_speed_percent), Integer(1, 100),
                           "Share of the axes' largest speed in motions between cuts."));
  std::ranges::copy(CornerKeys(), std::back_inserter(keys));
  keys.emplace_back(MaxCornerKey());
  keys.emplace_back(ExternalAxesKey({"E1", "E2", "E3", "GP2_J1", "GP2_J2", "GP2_J3"}, true));
  for (const SharedKey& key : {PathAccelerationKey(), CycleKey(FanucPost().UsualCycle()), BlockTimeKey(),
                               MaxMotionsKey(), MaxKbytesKey(), OutputsKey(false), TextsKey(), CallsKey()})
    keys.emplace_back(key);
  return EntryOf<FanucPost>(keys, Check);
}

}  // namespace millpose
