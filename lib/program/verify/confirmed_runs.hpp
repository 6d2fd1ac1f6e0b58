// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "program/verify/compare.hpp"

namespace millpose {

/// Feed runs that agreed with their plan and had no findings, by the hash of all that was compared: motions,
/// joint angles and frames of program and plan. A program that starts with a later cut runs the very motions
/// that the whole one does there; they are compared once. Holds for one cell and one VerifyOptions, of which
/// only what stands in the key may differ. Several threads may use it.
class ConfirmedRuns {
 public:
  using Proofs = std::map<std::string, std::vector<Proof>>;  ///< of the motions of every run, by its key

  /// All of VerifyOptions that a comparison of runs reads besides the key: where it is the same, and the
  /// cell, runs that were confirmed by other programs are confirmed. Nothing in a comparison asks where
  /// bodies stand.
  static std::string ContextOf(const VerifyOptions& options);

  static std::string KeyOf(const Replayed& replayed, const FeedRun& run, const Replayed& plan,
                           const FeedRun& plan_run, const VerifyOptions& options);
  /// Runs that were confirmed in the same context, of which Find() may make use. To be called first.
  void Know(Proofs known) { known_ = std::move(known); }
  /// What is known of each of its motions; empty where no such run was confirmed.
  std::vector<Proof> Find(const std::string& key) const;
  void Add(const std::string& key, std::vector<Proof> proofs);
  Proofs Used() const;   ///< those that were found or added
  size_t found() const;  ///< how often Find() had one
  size_t added() const;  ///< how many had to be compared

 private:
  mutable std::mutex mutex_;
  Proofs known_;
  mutable Proofs used_;
  mutable size_t found_ = 0;
  size_t added_ = 0;
};

}  // namespace millpose
