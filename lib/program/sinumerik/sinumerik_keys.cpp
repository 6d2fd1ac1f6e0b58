// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of `controllers.sinumerik` in a cell, and SINUMERIK's line in the registry.
#include "program/post_entry.hpp"
#include "program/sinumerik/sinumerik.hpp"

namespace millpose {
namespace {

using namespace yaml;  // NOLINT: tables are written in its words
using S = SinumerikOptions;

Codec<std::array<std::string, 6>> AxisNames() {
  const Codec<std::vector<std::string>> list = ListOf(Text());
  Codec<std::array<std::string, 6>> codec;
  codec.type = list.type;
  codec.schema = list.schema;
  codec.read = [read = list.read](const Value& value, const Context& context,
                                  std::array<std::string, 6>& result) {
    std::vector<std::string> names;
    const size_t problems_before = context.problems.size();
    read(value, context, names);
    if (context.problems.size() != problems_before) return;
    if (names.size() != 6)
      return context.Add(value.mark, fmt::format("given {} names; allowed: 6", names.size()));
    for (const std::string& name : names)
      if (!IsWord(name))
        context.Add(value.mark, fmt::format("given '{}'; allowed: letters, digits and '_'", name));
    std::ranges::copy(names, result.begin());
  };
  codec.write = [write = list.write](const std::array<std::string, 6>& names) {
    return write({names.begin(), names.end()});
  };
  return codec;
}

void Check(const Value& value, const Context& context, PostSection<S>& section) {
  if (!section.own.settable_frame)
    context.Add(value.mark,
                "settable_frame is missing: a whole number 505…599, the settable frame (G505…) that programs "
                "may overwrite with the workpiece's place; needed");
}

}  // namespace

PostEntry SinumerikEntry() {
  return EntryOf<SinumerikPost>(
      {ToolAxisKey(), RotationKey(), AxisSignsKey(), AxisOffsetsKey(),
       Key<S>("axis_names", MILLPOSE_AT(axis_names), AxisNames(),
              "Names of the six robot axes as channel axes, for motions without transformation."),
       ExternalAxesKey({}, false),
       Key<S>("settable_frame", MILLPOSE_AT(settable_frame), Maybe(Integer(505, 599)),
              "G505 to G599, the settable frame that programs overwrite with the workpiece's place; needed."),
       Key<S>("ori_ipo_with_g_code", MILLPOSE_AT(ori_ipo_with_g_code), Maybe(Flag()),
              "MD21104; where it is not given, blocks are so short that every way to turn the tool will do."),
       Key<S>("ori_def_with_g_code", MILLPOSE_AT(ori_def_with_g_code), Maybe(Flag()),
              "MD21102; whether the program's ORIRPY or ORIEULER counts, or MD21100."),
       PathAccelerationKey(), CycleKey(SinumerikPost().UsualCycle()), BlockTimeKey(), MaxMotionsKey(),
       MaxKbytesKey(), OutputsKey(false), TextsKey(), CallsKey()},
      Check);
}

}  // namespace millpose
