// SPDX-License-Identifier: GPL-3.0-or-later
// What every point of a tool path takes off, and the mean force on the cutter there (docs/engagement.md).
#pragma once

#include <optional>
#include <stop_token>

#include "toolpath/engagement/drill_lips.hpp"
#include "toolpath/engagement/standing.hpp"

namespace millpose {

/// A cut that the job states in place of what the path and the stock say.
struct StatedCut {
  MillingSide side = MillingSide::kDown;
  double width = 0;  ///< mm; ignored for a slot
};

struct EngagementOptions {
  EdgeModel edge;
  double spindle_speed = 0;  ///< rev/s
  double depth = 0;          ///< mm, of one layer; where more stands, more is cut
  InMaterial stock;          ///< before the first pass
  std::optional<StatedCut> stated;
  /// The tool cuts with its point, straight down its axis. Without `stock` it goes into the full.
  std::optional<DrillLips> drill;
  /// What the forces of each side of the cut are multiplied by.
  double up_factor = 1, down_factor = 1, slot_factor = 1;

  double FactorOf(CutSide side) const;
};

/// Sets `engagement` of all points. Each sees the stock less what points before it have taken off, those of
/// its own pass too; points with a gouge take nothing off. Lead-ins and lead-outs count as they run. `of`:
/// by pass and point, those that are set alone; empty: all. Throws Interrupted.
void SetEngagement(const EngagementOptions& options, int threads, const std::stop_token& stop,
                   Toolpath& toolpath, const std::vector<std::vector<char>>& of = {});

/// The same where it is set for the path without these gouges: anew for the points near one alone. Not for
/// tools that cut with their point.
void SetEngagementBesideMissing(const EngagementOptions& options, int threads, const std::stop_token& stop,
                                Toolpath& toolpath);

/// The greatest of the forces over a revolution, and how many teeth cut on average, where the mean is
/// greatest.
CuttingForce HeaviestCut(const EngagementOptions& options, const Toolpath& toolpath);

}  // namespace millpose
