// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace millpose {

/// What keeps a candidate's pose, or a whole milling point, from being used. The first ones are those of a
/// single pose, in the order in which they are tested, so that the greatest of several poses came nearest; of
/// a point they say that no pose of it came further. The others are known of points of a plan alone.
enum class Infeasibility : uint8_t {
  kNone,         ///< admissible; of a point: planned
  kUnreachable,  ///< the closed form has no solution
  kLimit,        ///< beyond a joint limit less the margin
  kSingular,     ///< too near a singularity, or below the least dexterity
  kInterference,
  kStep,         ///< no joint step within the bounds leads to it
  kSource,       ///< the tool path's source says so
  kGouge,        ///< the cutter would go into the part
  kAccess,       ///< no way leads to its piece or from it
  kOverMissing,  ///< would cut what was to be cut by skipped points before it
  kIncomplete,   ///< other points of a pass that is milled whole or not at all (a hole) are skipped
  kStock,        ///< what hangs on the tool would meet material that still stands
};

/// The word in points.csv, summary.json and reports.
std::string ToString(Infeasibility obstacle);

/// Of a single pose: how many of the three tests it passes, all where it is admissible.
constexpr int TestsPassed(Infeasibility obstacle) {
  return obstacle == Infeasibility::kNone ? 3 : static_cast<int>(obstacle) - 1;
}

}  // namespace millpose
