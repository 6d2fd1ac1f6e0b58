// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of `controllers.sinumerik` in a cell, and SINUMERIK's line in the registry.
#include "program/post_entry.hpp"
#include "program/sinumerik/sinumerik.hpp"
#include "program/sinumerik/sinumerik_block.hpp"

namespace millpose {
namespace {

using namespace yaml;  // NOLINT: tables are written in its words
using S = SinumerikOptions;

/// A list of N words.
template <size_t N>
Codec<std::array<std::string, N>> Names() {
  const Codec<std::vector<std::string>> list = ListOf(Text());
  Codec<std::array<std::string, N>> codec;
  codec.type = list.type;
  codec.schema = list.schema;
  codec.read = [read = list.read](const Value& value, const Context& context,
                                  std::array<std::string, N>& result) {
    std::vector<std::string> names;
    const size_t problems_before = context.problems.size();
    read(value, context, names);
    if (context.problems.size() != problems_before) return;
    if (names.size() != N)
      return context.Add(value.mark, fmt::format("given {} names; allowed: {}", names.size(), N));
    for (const std::string& name : names)
      if (!IsWord(name))
        context.Add(value.mark, fmt::format("given '{}'; allowed: letters, digits and '_'", name));
    std::ranges::copy(names, result.begin());
  };
  codec.write = [write = list.write](const std::array<std::string, N>& names) {
    return write({names.begin(), names.end()});
  };
  return codec;
}

Codec<OrientationWords> OrientationFields() {
  using O = OrientationWords;
  return Section<O>(
      {Key<O>("names", MILLPOSE_AT(names), Names<3>(),
              "Words of the three angles: about X, Y, Z (orirpy, orirpy2), or about Z, the new X, the new Z "
              "(orieuler). Machine data MD10620; A2, B2, C2 in the programming manuals.")
           .Required(),
       Key<O>("group", MILLPOSE_AT(group), ChoiceOf(kOrientationGroupWords),
              "G word that says how they count: orirpy Z, Y', X''; orirpy2 X, Y', Z''; orieuler Z, X', Z''.")
           .Required()},
      [](const Value& value, const Context& context, O& words) {
        for (size_t i = 0; i < words.names.size(); ++i) {
          const std::string& name = words.names[i];
          const bool twice = std::count(words.names.begin(), words.names.end(), name) > 1;
          const bool angle = name == "A" || name == "B" || name == "C";
          if (twice || (!angle && SinumerikBlock::IsAddress(name)))
            context.Child("names").Add(
                value.Find("names")->mark,
                fmt::format("given '{}'; allowed: a word that means nothing else, once", name));
        }
      });
}

/// What programs turn the tool by, and no cell can leave open: manuals and machines differ in it.
void Check(const Value& value, const Context& context, PostSection<S>& section) {
  const S& own = section.own;
  const auto need = [&](bool given, const char* what) {
    if (!given) context.Add(value.mark, what);
  };
  need(own.settable_frame.has_value(),
       "settable_frame is missing: a whole number 505…599, the settable frame (G505…) that programs "
       "may overwrite with the workpiece's place; needed");
  need(own.orientation_words.has_value(),
       "orientation_words is missing: {names: [A2, B2, C2], group: orirpy}, the words of the tool's angles "
       "on this "
       "machine (MD10620) and the G word by which they count; needed (docs/sinumerik.md)");
  need(own.stat_a5_positive.has_value(),
       "stat_a5_positive is missing: true where bit 2 of STAT means A5 > 0 on this machine, false where it "
       "means "
       "A5 < 0; needed: manuals have both (docs/sinumerik.md)");
  if (own.orientation_words) section.shared.rotation = own.orientation_words->group;
}

}  // namespace

PostEntry SinumerikEntry() {
  return EntryOf<SinumerikPost>(
      {ToolAxisKey(), AxisSignsKey(), AxisOffsetsKey(), AxisCouplingsKey(),
       Key<S>("axis_names", MILLPOSE_AT(axis_names), Names<6>(),
              "Names of the six robot axes as channel axes, for motions without transformation."),
       ExternalAxesKey({}, false),
       Key<S>("settable_frame", MILLPOSE_AT(settable_frame), Maybe(Integer(505, 599)),
              "G505 to G599, the settable frame that programs overwrite with the workpiece's place; needed."),
       Key<S>("ori_ipo_with_g_code", MILLPOSE_AT(ori_ipo_with_g_code), Maybe(Flag()),
              "MD21104; where it is not given, blocks are so short that every way to turn the tool will do."),
       Key<S>("ori_def_with_g_code", MILLPOSE_AT(ori_def_with_g_code), Maybe(Flag()),
              "MD21102; whether the program's ORIRPY or ORIEULER counts, or MD21100."),
       Key<S>("orientation_words", MILLPOSE_AT(orientation_words), Maybe(OrientationFields()),
              "The words of the tool's orientation; needed."),
       Key<S>("stat_a5_positive", MILLPOSE_AT(stat_a5_positive), Maybe(Flag()),
              "Whether bit 2 of STAT means A5 > 0, or A5 < 0, A5 counted as the arm's; needed."),
       PathAccelerationKey(), CycleKey(SinumerikPost().UsualCycle()), BlockTimeKey(), MaxMotionsKey(),
       MaxKbytesKey(), OutputsKey(false), TextsKey(), CallsKey()},
      Check);
}

}  // namespace millpose
