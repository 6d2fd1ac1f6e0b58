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
  static std::string KeyOf(const Replayed& replayed, const FeedRun& run, const Replayed& plan,
                           const FeedRun& plan_run, const VerifyOptions& options);
  /// What is known of each of its motions; empty where no such run was confirmed.
  std::vector<Proof> Find(const std::string& key) const;
  void Add(const std::string& key, std::vector<Proof> proofs);
  size_t found() const;  ///< how often Find() had one

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::vector<Proof>> proofs_;
  mutable size_t found_ = 0;
};

}  // namespace millpose
