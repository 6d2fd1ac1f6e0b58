// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/confirmed_runs.hpp"

#include "base/value_bytes.hpp"

namespace millpose {
namespace {

/// All that a comparison reads of a run and of where it begins. A field that the program or its motions get
/// later has to be sorted in here, or this does not compile.
void AddRun(const Replayed& replayed, const FeedRun& run, ValueBytes& bytes) {
  const auto& [name, header, external_axes, X_WB, X_BP, X_FT, axes, rotation, R_TC, blend_is_distance, swivel,
               any_turn, frames_checked, blend_overlaps, corner_assumption, motions, events, calls,
               switches_spindle, notice, files] = replayed.program;
  bytes.Add(external_axes, X_WB, X_BP, X_FT, axes.matrix(), axes.offset(), rotation, R_TC, blend_is_distance,
            swivel, any_turn, blend_overlaps, corner_assumption);
  for (size_t i = run.first - 1; i <= run.last; ++i) {
    const auto& [type, X_PT, q, status, turn, least, external, frame, frame_at_begin, feed, duration, angles,
                 turn_speed, clearance_share, exact, blend, angle_blend, call, pass, point, file, line] =
        motions[i];
    bytes.Add(type, X_PT, q, status, turn, least, external, frame, frame_at_begin, feed, duration, angles,
              turn_speed, clearance_share, exact, blend, angle_blend, call, pass, point,
              replayed.replay.targets[i], static_cast<bool>(replayed.replay.reached[i]));
  }
}

}  // namespace

std::string ConfirmedRuns::KeyOf(const Replayed& replayed, const FeedRun& run, const Replayed& plan,
                                 const FeedRun& plan_run, const VerifyOptions& options) {
  Hasher hasher;
  ValueBytes bytes(hasher);
  bytes.Add(options.clearance_reserve);
  AddRun(replayed, run, bytes);
  AddRun(plan, plan_run, bytes);
  bytes.HandOn();
  return hasher.Digits();
}

std::string ConfirmedRuns::ContextOf(const VerifyOptions& options) {
  // Every field has its name here, so that one that is added cannot be forgotten.
  const auto& [position_tolerance, angle_tolerance, max_corner, step, lower, upper, coupled, swept_resolution,
               clearance_reserve, feed_least, feed_most, spindle_tolerance, gap_tolerance, gap_proven,
               jump_time, feed_jump, wrist_least, interference, as_it_is, most_findings, written, confirmed] =
      options;
  return HashOfValues(position_tolerance, angle_tolerance, max_corner, step, lower, upper, coupled,
                      swept_resolution, clearance_reserve, feed_least, feed_most, gap_tolerance, gap_proven,
                      jump_time, feed_jump, wrist_least);
}

std::vector<Proof> ConfirmedRuns::Find(const std::string& key) const {
  const std::lock_guard lock(mutex_);
  auto found = used_.find(key);
  if (found == used_.end()) {
    const auto known = known_.find(key);
    if (known == known_.end()) return {};
    found = used_.insert(*known).first;
  }
  ++found_;
  return found->second;
}

ConfirmedRuns::Proofs ConfirmedRuns::Used() const {
  const std::lock_guard lock(mutex_);
  return used_;
}

size_t ConfirmedRuns::found() const {
  const std::lock_guard lock(mutex_);
  return found_;
}

size_t ConfirmedRuns::added() const {
  const std::lock_guard lock(mutex_);
  return added_;
}

void ConfirmedRuns::Add(const std::string& key, std::vector<Proof> proofs) {
  const std::lock_guard lock(mutex_);
  added_ += used_.try_emplace(key, std::move(proofs)).second;
}

}  // namespace millpose
