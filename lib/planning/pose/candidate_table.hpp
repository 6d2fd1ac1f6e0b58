// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "planning/pose/scorer.hpp"

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

  /// A grid over every freedom, ends included: of its own step about its nominal value where it has one, else
  /// of at most `step` (rad or mm, as the freedom). Throws InputError where it would take more than half of
  /// the machine's memory.
  static CandidateTable OfStep(const PointScorer& scorer, double step);
  /// A grid of at most `settings` settings (and at least two of each freedom), as many of one freedom as of
  /// any other.
  static CandidateTable OfSize(const PointScorer& scorer, int settings);

  /// What a table of every branch of so many settings takes at most, bytes.
  static double BytesOf(double settings) { return settings * 8 * sizeof(Entry); }

  /// Ascending by setting, then by branch.
  const std::vector<Entry>& entries() const { return entries_; }
  /// The furthest that any candidate came; what says why there are no entries.
  Infeasibility reason() const { return reason_; }

  size_t settings() const { return settings_; }
  /// Ascending by the first freedom, then by the second, and so on.
  FreedomValues Setting(size_t index) const;
  /// A line of settings that differ in the first freedom alone: `line_length()` of them, `stride()` apart. So
  /// setting % stride() says how the others are set.
  int line_length() const { return static_cast<int>(values_[0].size()); }
  size_t stride() const { return settings_ / values_[0].size(); }
  /// Value `i` of freedom `d`; of the first also beyond its ends.
  double At(size_t d, int i) const;

 private:
  /// The values of each freedom, ascending; the first at even steps.
  CandidateTable(const PointScorer& scorer, std::vector<std::vector<double>> values);

  std::vector<std::vector<double>> values_;
  double first_step_;
  size_t settings_ = 1;
  std::vector<Entry> entries_;
  Infeasibility reason_ = Infeasibility::kUnreachable;
};

}  // namespace millpose
