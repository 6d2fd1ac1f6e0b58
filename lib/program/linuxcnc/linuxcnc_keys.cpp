// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of `controllers.linuxcnc` in a cell, and LinuxCNC's line in the registry.
#include "program/linuxcnc/linuxcnc.hpp"
#include "program/post_entry.hpp"

namespace millpose {

PostEntry LinuxCncEntry() {
  using namespace yaml;  // NOLINT: tables are written in its words
  using S = LinuxCncOptions;
  return EntryOf<LinuxCncPost>(
      {ToolAxisKey(), RotationKey(), AxisSignsKey(), AxisOffsetsKey(), AxisCouplingsKey(),
       Key<S>("coordinates", MILLPOSE_AT(cartesian), ChoiceOf<bool>({{"joint", false}, {"cartesian", true}}),
              "X Y Z A B C are joints throughout, or the tool's pose in cuts."),
       Key<S>("m6_moves", MILLPOSE_AT(m6_moves), Maybe(Flag()),
              "Whether the machine moves by itself at M6: TOOL_CHANGE_POSITION, TOOL_CHANGE_AT_G30 or "
              "TOOL_CHANGE_QUILL_UP in its ini file. Needed where programs have M6, and must then be false."),
       ExternalAxesKey({"U", "V", "W"}, false), PathAccelerationKey(), CycleKey(LinuxCncPost().UsualCycle()),
       BlockTimeKey(), OutputsKey(false), TextsKey({"cartesian_on", "joints_on"}), CallsKey()});
}

}  // namespace millpose
