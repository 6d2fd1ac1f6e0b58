// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/point_verdicts.hpp"

#include <bit>

namespace millpose {
namespace {

template <typename Bits>
void Put(const Joints& q, size_t at, Bits& bits) {
  for (int i = 0; i < 6; ++i) bits.of[at + static_cast<size_t>(i)] = std::bit_cast<uint64_t>(q[i]);
}

}  // namespace

const std::optional<ContactCandidate>& PointVerdicts::OfPose(Checker& checker, const Joints& q) {
  Bits<6> bits;
  Put(q, 0, bits);
  const auto [known, unknown] = poses_.try_emplace(bits);
  if (unknown) known->second = checker.Blocked(q, Phase::kCutting);
  return known->second;
}

const std::optional<ContactCandidate>& PointVerdicts::OfCandidate(Checker& checker,
                                                                  const FreedomValues& freedoms,
                                                                  const Joints& q, const PassChecks& checks) {
  if (!checks.rotates_first) return OfPose(checker, q);
  Bits<6> bits;
  Put(q, 0, bits);
  const auto [known, unknown] = poses_.try_emplace(bits);
  if (unknown) known->second = checker.Blocked(q, Phase::kCutting, freedoms, shared_);
  return known->second;
}

const std::optional<CutProblem>& PointVerdicts::OfMotion(PassCheckers& checkers, size_t t, const Joints& q0,
                                                         const Joints& q1, const PassChecks& checks) {
  Bits<12> bits;
  Put(q0, 0, bits);
  Put(q1, 6, bits);
  const auto [known, unknown] = motions_.try_emplace(bits);
  if (unknown) known->second = CheckCut(checkers, checks, t, q0, q1);
  return known->second;
}

}  // namespace millpose
