// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "pose/scorer.hpp"

namespace millpose {

/// Every candidate of one point on a grid over its freedoms, scored once: what searches by grid reads.
class CandidateTable {
 public:
  /// An admissible candidate.
  struct Entry {
    uint32_t setting;  ///< of the freedoms
    uint8_t branch;
    double objective;
    Joints q;  ///< as Candidate::q, rad
  };

  /// A grid of at most `step` (rad or mm, as the freedom) over every freedom, ends included.
  static CandidateTable OfStep(const PointScorer& scorer, double step);
  /// A grid of at most `settings` settings (and at least two of each freedom), as many of one freedom as of
  /// any other.
  static CandidateTable OfSize(const PointScorer& scorer, int settings);

  /// Ascending by setting, then by branch.
  const std::vector<Entry>& entries() const { return entries_; }
  /// The furthest that any candidate came; what says why there are no entries.
  Obstacle reason() const { return reason_; }

  size_t settings() const { return settings_; }
  /// Ascending by the first freedom, then by the second, and so on.
  FreedomValues Setting(size_t index) const;
  /// A line of settings that differ in the first freedom alone: `line_length()` of them, `stride()` apart.
  int line_length() const { return counts_[0]; }
  size_t stride() const { return settings_ / static_cast<size_t>(counts_[0]); }
  /// Value `i` of freedom `d`.
  double At(size_t d, int i) const { return lower_[d] + i * step_[d]; }

 private:
  CandidateTable(const PointScorer& scorer, const std::vector<int>& intervals);

  std::vector<int> counts_;  ///< of each freedom's values
  std::vector<double> lower_, step_;
  size_t settings_ = 1;
  std::vector<Entry> entries_;
  Obstacle reason_ = Obstacle::kUnreachable;
};

}  // namespace millpose
