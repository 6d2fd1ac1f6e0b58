// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/tell_nearest.hpp"

#include "planning/result/point_clearance.hpp"

namespace millpose {

void TellNearest(const std::optional<Interference>& found, PlannedPoint& point, PassResult& pass) {
  const auto number_of = [&](const std::string& name) {
    const auto known = std::ranges::find(pass.bodies, name);
    if (known != pass.bodies.end()) return static_cast<int>(known - pass.bodies.begin());
    pass.bodies.push_back(name);
    return static_cast<int>(pass.bodies.size()) - 1;
  };
  point.clearance = kPointClearanceBound;
  point.nearest.reset();
  if (!found) return;
  point.clearance = found->distance;
  const int first = number_of(found->first), second = number_of(found->second);
  point.nearest = NearestPair{first, second, found->ends[0], found->ends[1]};
}

}  // namespace millpose
