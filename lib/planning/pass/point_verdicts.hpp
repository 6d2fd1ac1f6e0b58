// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>

#include "machine/collision/point_memory.hpp"
#include "planning/pass/cut_check.hpp"
#include "planning/pass/pass_checks.hpp"
#include "planning/pose/freedom.hpp"

namespace millpose {

/// What is known of the poses at one milling point and of the motions that begin there, while a pass cuts. It
/// lives as long as its pass is being planned, however often that is tried: a verdict is a function of its
/// pose or motion alone, so what was looked at is not looked at again. Used by one thread at a time.
class PointVerdicts {
 public:
  /// The first pair that interferes at joint angles q.
  const std::optional<ContactCandidate>& OfPose(Checker& checker, const Joints& q);
  /// The same of the pose with these freedoms, by what poses of the point share (PointMemory).
  const std::optional<ContactCandidate>& OfCandidate(Checker& checker, const FreedomValues& freedoms,
                                                     const Joints& q, const PassChecks& checks);
  /// What is in the way of the straight motion from q0 at this point, `t` of the pass, to q1 at the next
  /// (CheckCut).
  const std::optional<CutProblem>& OfMotion(PassCheckers& checkers, size_t t, const Joints& q0,
                                            const Joints& q1, const PassChecks& checks);

 private:
  /// Angles bit by bit.
  template <size_t kCount>
  struct Bits {
    std::array<uint64_t, kCount> of;
    bool operator==(const Bits&) const = default;
  };
  struct Hash {
    template <size_t kCount>
    size_t operator()(const Bits<kCount>& bits) const {
      uint64_t hash = 0;
      for (const uint64_t word : bits.of) {
        hash = (hash ^ word) * 0x9e3779b97f4a7c15U;
        hash ^= hash >> 32U;
      }
      return hash;
    }
  };

  PointMemory shared_;
  std::unordered_map<Bits<6>, std::optional<ContactCandidate>, Hash> poses_;
  std::unordered_map<Bits<12>, std::optional<CutProblem>, Hash> motions_;
};

}  // namespace millpose
