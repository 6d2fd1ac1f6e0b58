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
  double feed = 0;  ///< mm/s
};

/// Reads DRILL, DEEP, BRKCHP and FACE with DEPTH or FEDTO, CLEAR or RAPTO, RTRCTO, STEP, DWELL and a feed.
/// What is no plain motion, or has a word that is not known, becomes a cycle whose holes are left out. `feed`
/// is the one in force, `unit` the file's length unit in mm. Throws InputError for numbers that cannot be.
AptCycle ReadCycle(const AptStatement& statement, AptFeed feed, double unit);

}  // namespace millpose
