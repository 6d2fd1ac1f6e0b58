// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of `controllers.rapid` in a cell, and RAPID's line in the registry.
#include "program/post_entry.hpp"
#include "program/rapid/rapid.hpp"

namespace millpose {
namespace {

using namespace yaml;  // NOLINT: tables are written in its words
using S = RapidOptions;

const Unit kMillimetrePerS{"mm/s", 1, 1};

Codec<RapidWorkUnit> WorkUnitFields() {
  using U = RapidWorkUnit;
  return Section<U>({
      Key<U>("name", MILLPOSE_AT(name), Text(), "Mechanical unit, as wobjdata name it (ufmec): STN1.")
          .Required(),
      Key<U>("frame", MILLPOSE_AT(frame), PoseFields(),
             "Its user frame in the controller's world, with its axes at 0.")
          .Required(),
  });
}

std::vector<Field<S>> FrameAndSpeedKeys() {
  return {
      Key<S>(
          "base_frame", MILLPOSE_AT(base_frame), PoseFields(),
          "The robot's base frame in the controller's world (Configuration, Motion, Robot); with a coupled "
          "rail: with its axis at 0."),
      Key<S>("way_speed_mm_s", MILLPOSE_AT(way_speed), Real(kMillimetrePerS, Between(1, 5000)),
             "Largest speed of the tip between cuts (MoveAbsJ)."),
      Key<S>("orientation_speed_deg_s", MILLPOSE_AT(orientation_speed), Real(kDegPerS, Positive(1000)),
             "v_ori of all speeddata: largest turning of the tool."),
      Key<S>("signal_prefix", MILLPOSE_AT(signal_prefix), Text(),
             "What stands before the number of an output in its signal's name: do5."),
  };
}

std::vector<Field<S>> UnitAndMemoryKeys() {
  return {
      Key<S>("activate_units", MILLPOSE_AT(activate_units), ListOf(Text()),
             "Mechanical units that programs activate before their first motion (ActUnit).")
          .WhenSet([](const S& s) { return !s.activate_units.empty(); }),
      Key<S>("work_unit", MILLPOSE_AT(work_unit), Maybe(WorkUnitFields()),
             "The positioner that carries the workpiece, where the controller counts in it (coupled)."),
      Key<S>("load_from", MILLPOSE_AT(load_from), Text(),
             "Folder at the controller, \"HOME:/millpose\": modules of long programs are loaded from it one "
             "after the other (Load, UnLoad) and need no room together.")
          .WhenSet([](const S& s) { return !s.load_from.empty(); }),
      Key<S>("program_memory_kbytes", MILLPOSE_AT(memory_kbytes), Maybe(Integer(100, 10000000)),
             "Memory for programs, kB, as the pendant shows it; larger programs are warned of.")
          .DefaultText("no such bound"),
  };
}

/// A folder that a text in quotes can hold, without what a path must not end in.
bool IsFolder(const std::string& text) {
  const auto odd = [](char c) { return c < ' ' || c > '~' || c == '"' || c == '\\'; };
  return !text.empty() && text.size() <= 60 && std::ranges::none_of(text, odd) && !text.ends_with('/');
}

void Check(const Value& value, const Context& context, PostSection<S>& section) {
  const S& own = section.own;
  const auto word = [&](const char* key, const std::string& name) {
    if (IsWord(name)) return;
    context.Child(key).Add(
        value.FindKey(key)->mark,
        fmt::format("given '{}'; allowed: letters, digits and '_', at most 31, beginning with a letter",
                    name));
  };
  word("signal_prefix", own.signal_prefix);
  for (const std::string& unit : own.activate_units) word("activate_units", unit);
  if (own.work_unit) word("work_unit", own.work_unit->name);
  if (!own.load_from.empty() && !IsFolder(own.load_from))
    context.Child("load_from")
        .Add(value.FindKey("load_from")->mark,
             fmt::format(
                 "given '{}'; allowed: a folder such as HOME:/millpose, at most 60 characters, without "
                 "quotes, backslashes and a '/' at its end",
                 own.load_from));
}

}  // namespace

PostEntry RapidEntry() {
  std::vector<PostKey<S>> keys = {ToolAxisKey(), AxisSignsKey(), AxisOffsetsKey()};
  keys.emplace_back(ExternalAxesKey(RapidAxisNames(), true));
  std::ranges::copy(FrameAndSpeedKeys(), std::back_inserter(keys));
  keys.emplace_back(PathAccelerationKey());
  std::ranges::copy(UnitAndMemoryKeys(), std::back_inserter(keys));
  keys.emplace_back(CycleKey(RapidPost().UsualCycle()));
  for (const SharedKey& key :
       {BlockTimeKey(), MaxMotionsKey(), MaxKbytesKey(), OutputsKey(false), TextsKey(), CallsKey()})
    keys.emplace_back(key);
  return EntryOf<RapidPost>(keys, Check);
}

}  // namespace millpose
