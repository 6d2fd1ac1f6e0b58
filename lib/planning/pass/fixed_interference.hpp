// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "planning/pass/fixed_rotation.hpp"
#include "planning/pass/fixed_table.hpp"

namespace millpose {

/// Whether fixed rotations are free of interference over a planned pass. Where one of them met something is
/// looked at first for all that follow.
class FixedInterference {
 public:
  FixedInterference(const Stations& stations, const PassResult& pass, const FixedRotationOptions& options);

  /// At every planned point and on every motion between two; the ends of pieces can be left too.
  bool IsFree(double rotation, int branch);
  /// Points at which something was met, or on the way to which: the first few that were found.
  const std::vector<size_t>& met() const { return met_; }

 private:
  bool Leaves(const Station& station, const Joints& planned, const Joints& q) const;

  const Stations& stations_;
  const PassResult& pass_;
  const FixedRotationOptions& options_;
  std::vector<size_t> order_;  ///< planned points
  std::vector<size_t> met_;
};

}  // namespace millpose
