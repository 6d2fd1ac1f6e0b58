// SPDX-License-Identifier: GPL-3.0-or-later
// Interference along a path that is being shifted: its points and the straight motions between them.
#pragma once

#include "path/refine.hpp"
#include "path/strike_out.hpp"

namespace millpose {

/// What of a piece interferes.
struct PieceHits {
  std::vector<char> pose;    ///< per point
  std::vector<char> motion;  ///< per motion from a point to the next; the last closes a ring
  bool any() const;
  /// Points that interfere, or are at an end of a motion that does.
  std::vector<bool> Points() const;
};

/// Checks pieces in Phase::kCutting.
class PieceChecker {
 public:
  PieceChecker(const World& world, const Carrier& carrier, double swept_resolution, int threads,
               std::stop_token stop)
      : world_(world), carrier_(carrier), resolution_(swept_resolution), threads_(threads), stop_(stop) {}

  /// Points whose pose is `known` to be free are not looked at, nor are motions between two of them.
  PieceHits Check(std::span<const PathNode> path, bool closed, const std::vector<bool>& known);

  bool PoseFree(Checker& checker, const Joints& q) const;
  bool MotionFree(Checker& checker, const Joints& from, const Joints& to) const;
  /// Runs `work(checker, i)` for i in 0..count−1 in parallel.
  void Each(size_t count, const std::function<void(Checker&, size_t)>& work);

  long long poses_checked() const { return poses_checked_; }

 private:
  const World& world_;
  const Carrier& carrier_;
  double resolution_;
  int threads_;
  std::stop_token stop_;
  long long poses_checked_ = 0;
};

/// The points of `marked` and `reach` more to either side, round the end of a closed piece.
std::vector<bool> Widened(const std::vector<bool>& marked, size_t reach, bool closed);

}  // namespace millpose
