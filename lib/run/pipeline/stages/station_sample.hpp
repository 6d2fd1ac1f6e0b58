// SPDX-License-Identifier: GPL-3.0-or-later
// What a sample of a pass's points promises with the external axes somewhere.
#pragma once

#include <functional>

#include "planning/external/station_sequence.hpp"
#include "planning/external/stations.hpp"
#include "planning/links/retract.hpp"
#include "planning/pose/candidate_table.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

/// Some points of a pass, evenly over it, its ends among them; none that the cutter would gouge at.
Pass SampleOf(const Pass& pass);

/// A point of a sample at a station, given in W there.
class SampledPoint {
 public:
  /// `end`: the tool must have room to leave there. All but the last two outlive it.
  SampledPoint(const Station& station, Checker& checker, const RetractOptions& leave,
               const MillingPoint& point, const Eigen::Vector3d& rotation_reference, bool end);

  /// The least objective of a free rotation on a branch; infinite where there is none.
  double Best(size_t branch) const;

 private:
  Checker& checker_;
  const RetractOptions& leave_;
  Carrier carrier_;
  CandidateTable table_;
  bool end_;
};

/// On the branch that serves a sample of `count` points best; `best(t, branch)` is a point's
/// (SampledPoint::Best).
StationScore ScoreOf(size_t count, const std::function<double(size_t, size_t)>& best);

}  // namespace millpose
