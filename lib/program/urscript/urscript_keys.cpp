// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of `controllers.urscript` in a cell, and URScript's line in the registry.
#include "program/post_entry.hpp"
#include "program/urscript/urscript.hpp"

namespace millpose {

PostEntry UrScriptEntry() {
  using namespace yaml;  // NOLINT: tables are written in its words
  using S = UrScriptOptions;
  SharedKey acceleration = PathAccelerationKey();
  acceleration.info.doc = "`a` of the motions in cuts, also for the estimate of the speed (0.5 by default).";
  return EntryOf<UrScriptPost>(
      {ToolAxisKey(), AxisSignsKey(), AxisOffsetsKey(),
       Key<S>("cut_motion", MILLPOSE_AT(movel), ChoiceOf<bool>({{"movep", false}, {"movel", true}}),
              "Statement of the motions in cuts: movep keeps the tool's speed through blends."),
       Key<S>("movej_speed_percent", MILLPOSE_AT(movej_speed_percent), Integer(1, 100),
              "Share of the slowest joint's largest speed in motions between cuts."),
       MaxCornerKey(), acceleration, CycleKey(UrScriptPost().UsualCycle()), BlockTimeKey(), OutputsKey(false),
       TextsKey(), CallsKey()});
}

}  // namespace millpose
