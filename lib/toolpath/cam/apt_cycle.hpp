// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "toolpath/cam/apt_feed.hpp"
#include "toolpath/cam/apt_scanner.hpp"
#include "toolpath/cam/drilling.hpp"

namespace millpose {

/// A CYCLE statement: what is done at each GOTO until CYCLE/OFF. Heights are mm from that point along the
/// tool axis.
struct AptCycle {
  std::string name;             ///< "CYCLE/DRILL", for messages
  std::string left_out;         ///< why its holes are left out; empty: they are drilled
  std::vector<double> strokes;  ///< heights, see Heights()
  double clearance = 0, retract = 0;
  double feed = 0;                 ///< mm/s
  std::optional<double> by_place;  ///< the depth of a cycle by places, see CyclePoint; no other has one
  std::optional<double> step;      ///< of the strokes
  double chip_retract = 0;         ///< see Drilling
  SourceLocation place;
};

/// A cycle by places whose GOTO is at the hole's bottom, at `height` (mm) of the file's system along the tool
/// axis: its clearance was a height of that system; heights are counted from the bottom.
AptCycle FromBottom(const AptCycle& cycle, double height);

/// Reads DRILL, DEEP, BRKCHP and FACE with DEPTH or FEDTO, CLEAR or RAPTO, RTRCTO, STEP, DWELL and a feed, or
/// by places: depth, [INCR, step,] unit, feed, clearance, or depth, feed, unit, clearance; then DWELL.
/// What is no plain motion, or has a word that is not known, becomes a cycle whose holes are left out. `feed`
/// is the one in force, `unit` the file's length unit in mm. Throws InputError for numbers that cannot be.
AptCycle ReadCycle(const AptStatement& statement, AptFeed feed, double unit);

}  // namespace millpose
