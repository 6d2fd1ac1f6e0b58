// SPDX-License-Identifier: GPL-3.0-or-later
// How good the plan of a pass is, beside another plan of the same pass.
#pragma once

#include <functional>

#include "planning/result/plan_result.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

/// Half the way to the places before and behind the t-th of `count`, mm; `place(i)` is the i-th.
double WayAt(size_t t, size_t count, const std::function<Eigen::Vector3d(size_t)>& place);

/// Measured along the way, so that it does not depend on how densely the points lie.
struct PassValue {
  double skipped = 0;  ///< mm of way that is not cut
  size_t pieces = 0;
  double worst = 0;  ///< objective of the worst point that cuts
  double mean = 0;   ///< over the way that is cut
};
PassValue ValueOf(const PassResult& pass);

/// Whether less is skipped or, with no more skipped, fewer pieces are planned or, with no more of these, the
/// worst value (with `worst_first`) or else the mean is less by a share of more than `gain`; what the share
/// does not tell apart does not count against it.
bool IsBetter(const PassValue& now, const PassValue& before, bool worst_first, double gain);

/// Where the points of `pass`, from the first on (of a ring left open from where it begins), stand in its
/// plan, which may hold others between them. Shorter where not all were found.
std::vector<size_t> PlacesOf(const PassResult& plan, const Pass& pass);

}  // namespace millpose
