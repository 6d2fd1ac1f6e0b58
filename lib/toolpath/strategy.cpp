// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategy_entry.hpp"

namespace millpose {

/// Defined in the strategies' own files.
StrategyEntry ParallelPlanesEntry(), RingsEntry(), PadEntry(), ContoursEntry(), CurveEntry(), CamEntry(),
    DrillEntry(), TrimStrategyEntry(), RoughStrategyEntry();

Registry<StrategyEntry>& Strategies() {
  static Registry<StrategyEntry> strategies{
      "strategy",
      {ParallelPlanesEntry(), RingsEntry(), PadEntry(), ContoursEntry(), CurveEntry(), CamEntry(),
       DrillEntry(), TrimStrategyEntry(), RoughStrategyEntry()}};
  return strategies;
}

}  // namespace millpose
