// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace millpose {

/// s, of one pass or of a whole program.
struct CycleTime {
  double cuts = 0;        ///< at their feeds
  double approaches = 0;  ///< straight to and from cuts, at their feeds
  double gaps = 0;        ///< joint motions between cuts
  double stops = 0;       ///< what stops add to cuts and approaches: speeding up, slowing down, dwells

  double Total() const { return cuts + approaches + gaps + stops; }
  CycleTime& operator+=(const CycleTime& other);
};

/// Of every pass by its number, and of all motions; a gap counts for the pass that it leads to, the way home
/// for none.
struct ProgramTime {
  CycleTime all;
  std::vector<CycleTime> passes;
};

/// Of one controller's program.
struct ControllerTime {
  std::string controller;
  ProgramTime time;
};

/// "1:02:03", h:min:s.
std::string ClockText(double seconds);

/// "1:02:03 (cuts 0:55:00, approaches 0:04:00, gaps 0:02:00, stops 0:01:03)", h:min:s.
std::string TimeText(const CycleTime& time);

}  // namespace millpose
