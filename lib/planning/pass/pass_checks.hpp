// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <stop_token>

#include "planning/external/places_along.hpp"
#include "planning/pass/cut_check.hpp"
#include "planning/pass/lean_gouges.hpp"

namespace millpose {

/// By what the poses of a pass and the motions between them are checked.
struct PassChecks {
  const World& world;       ///< where axes move, with them at 0
  Carrier carrier;          ///< likewise
  double swept_resolution;  ///< mm
  bool rotates_first;  ///< the first freedom is the rotation about the tool axis, as PointMemory needs it
  int threads;
  std::stop_token stop;
  LeanGouges gouges = {};
  std::span<const PlaceAlong> along = {};  ///< of each point, where external axes move; else empty

  const World& WorldAt(size_t t) const { return along.empty() ? world : along[t].station->world; }
  /// With the axes where they are at point t; of the straight motion from there to the next.
  const Carrier& CarrierAt(size_t t) const { return along.empty() ? carrier : along[t].standing; }
  const Carrier& CarrierFrom(size_t t) const { return along.empty() ? carrier : along[t].onward; }
};

/// The checkers of one thread: one for all points or, where external axes move, one for each.
class PassCheckers {
 public:
  explicit PassCheckers(const PassChecks& checks);
  Checker& At(size_t t);
  /// Only where external axes move.
  CoordinatedChecker& Coordinated();
  CheckCounts counts() const;

 private:
  const PassChecks& checks_;
  std::optional<Checker> one_;
  std::map<size_t, Checker> own_;
  std::optional<CoordinatedChecker> riding_;
};

/// CheckCut of the motion from point t of the pass at q0 to the next at q1, along which external axes may
/// move.
std::optional<CutProblem> CheckCut(PassCheckers& checkers, const PassChecks& checks, size_t t,
                                   const Joints& q0, const Joints& q1);

/// Runs `work(checker, i)` for i in 0..count−1 in parallel with a few checkers.
CheckCounts CheckInParallel(const PassChecks& checks, size_t count,
                            const std::function<void(PassCheckers&, size_t)>& work);

/// One line: which two bodies, how near, where.
std::string Describe(const Interference& interference);

}  // namespace millpose
