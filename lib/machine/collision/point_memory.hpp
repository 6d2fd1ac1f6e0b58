// SPDX-License-Identifier: GPL-3.0-or-later
// What poses at one milling point share, so that it need not be looked at again.
#pragma once

#include <map>
#include <vector>

#include "machine/collision/world.hpp"

namespace millpose {

/// What was found of poses of one milling point in one phase. Only poses that meet the same point with the
/// same tool axis where all freedoms but the first are equal may share one.
class PointMemory {
 public:
  /// Pairs of a cell that give the same answer for many of these poses.
  enum class Kind : uint8_t {
    kTool,    ///< round bodies about the tool axis against what stands still: all rotations about that axis
    kFlange,  ///< the rest of tool and flange against what stands still: one setting of all freedoms, all
              ///< branches
    kArm,     ///< links 0 to 3: the same first three joint angles, either way of the wrist
    kOther,   ///< anything else: no two poses alike
  };
  /// What is known of the pairs of one kind; until then nothing.
  struct Entry {
    bool known = false;
    ContactCandidate found;  ///< the first that interferes; no pair when none does
  };

  /// `freedoms`: the pose's, the first the rotation about the tool axis. Entries by kind; null for kOther.
  std::array<Entry*, 4> Entries(const std::vector<double>& freedoms, const Joints& q) {
    const std::vector<double> axis(freedoms.begin() + 1, freedoms.end());
    return {&tool_[axis], &flange_[freedoms], &arm_[{q[0], q[1], q[2]}], nullptr};
  }

 private:
  std::map<std::vector<double>, Entry> tool_, flange_;
  std::map<std::array<double, 3>, Entry> arm_;
};

}  // namespace millpose
