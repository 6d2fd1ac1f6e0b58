// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/pass_checks.hpp"

#include "base/cpu_time.hpp"
#include "base/parallel.hpp"

namespace millpose {

PassCheckers::PassCheckers(const PassChecks& checks) : checks_(checks) {
  if (checks.along.empty()) one_.emplace(checks.world);
}

Checker& PassCheckers::At(size_t t) {
  if (one_) return *one_;
  return own_.try_emplace(t, checks_.WorldAt(t)).first->second;
}

CoordinatedChecker& PassCheckers::Coordinated() {
  if (!riding_) riding_.emplace(checks_.world);
  return *riding_;
}

CheckCounts PassCheckers::counts() const {
  CheckCounts sum;
  if (one_) sum += one_->counts();
  for (const auto& [t, checker] : own_) sum += checker.counts();
  if (riding_) sum += riding_->counts();
  return sum;
}

std::optional<CutProblem> CheckCut(PassCheckers& checkers, const PassChecks& checks, size_t t,
                                   const Joints& q0, const Joints& q1) {
  const Carrier& carrier = checks.CarrierFrom(t);
  if (carrier.ride) return CheckCut(checkers.Coordinated(), carrier, q0, q1, checks.swept_resolution);
  return CheckCut(checkers.At(t), carrier, q0, q1, checks.swept_resolution);
}

CheckCounts CheckInParallel(const PassChecks& checks, size_t count,
                            const std::function<void(PassCheckers&, size_t)>& work) {
  // Chunks of fixed size, a checker each: what a checker remembers cannot depend on the number of threads.
  constexpr size_t kChunk = 16;
  const size_t chunks = (count + kChunk - 1) / kChunk;
  std::vector<CheckCounts> counts(chunks);
  ParallelFor(chunks, checks.threads, checks.stop, [&](size_t chunk) {
    const CpuTimer timer(CpuPart::kInterference);
    PassCheckers checkers(checks);
    for (size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) work(checkers, i);
    counts[chunk] = checkers.counts();
  });
  CheckCounts sum;
  for (const CheckCounts& chunk : counts) sum += chunk;
  return sum;
}

std::string Describe(const Interference& interference) {
  return fmt::format("{} and {} {} at ({:.1f}, {:.1f}, {:.1f}) mm", interference.first, interference.second,
                     interference.distance > 0 ? fmt::format("come within {:.2f} mm", interference.distance)
                                               : std::string("touch"),
                     interference.place().x(), interference.place().y(), interference.place().z());
}

}  // namespace millpose
