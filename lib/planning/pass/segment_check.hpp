// SPDX-License-Identifier: GPL-3.0-or-later
// Interference along a path that is being shifted: its points and the straight motions between them.
#pragma once

#include <memory>

#include "planning/ladder/refine.hpp"
#include "planning/links/retract.hpp"
#include "planning/pass/point_verdicts.hpp"

namespace millpose {

/// What of a piece interferes.
struct SegmentHits {
  std::vector<char> pose;    ///< per point
  std::vector<char> motion;  ///< per motion from a point to the next; the last closes a ring
  bool any() const;
  /// Points that interfere, or are at an end of a motion that does.
  std::vector<bool> Points() const;
};

/// Shares of the clearances with which the ends of a piece must be left; 0: whatever is there.
struct EndShares {
  double first = 0, last = 0;
};

/// Checks a piece in Phase::kCutting.
class SegmentChecker {
 public:
  /// `known`: one per point of the piece. `leave`: with it the ends keep the retracts that they have.
  SegmentChecker(PassChecks checks, std::span<const std::shared_ptr<PointVerdicts>> known,
                 std::optional<RetractOptions> leave)
      : checks_(std::move(checks)), known_(known), leave_(leave) {}

  /// What the ends of a piece have; a ring is entered and left at its first point. 0 without `leave`.
  EndShares ToLeave(std::span<const PathNode> path, bool closed);

  /// Points whose pose is `known` to be free are not looked at, nor are motions between two of them.
  SegmentHits Check(std::span<const PathNode> path, bool closed, const EndShares& ends,
                    const std::vector<bool>& known);

  /// Whether the tool can leave `q` at point i with a share of the clearances; with 0 always.
  bool Leaves(size_t i, const Joints& q, double share) const;

  /// Of a pose at point i, and of the motion from there.
  bool PoseFree(PassCheckers& checkers, size_t i, const Joints& q) const;
  bool MotionFree(PassCheckers& checkers, size_t i, const Joints& from, const Joints& to) const;
  /// Runs `work(checkers, i)` for i in 0..count−1 in parallel.
  void Each(size_t count, const std::function<void(PassCheckers&, size_t)>& work);

  const PassChecks& checks() const { return checks_; }
  long long poses_checked() const { return poses_checked_; }

 private:
  PassChecks checks_;
  std::span<const std::shared_ptr<PointVerdicts>> known_;
  std::optional<RetractOptions> leave_;
  long long poses_checked_ = 0;
};

/// The points of `marked` and `reach` more to either side, round the end of a closed piece.
std::vector<bool> Widened(const std::vector<bool>& marked, size_t reach, bool closed);

}  // namespace millpose
