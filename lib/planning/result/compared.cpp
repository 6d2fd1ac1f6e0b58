// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/compared.hpp"

#include <algorithm>

namespace millpose {

bool MaterialIsKnown(const std::vector<PassResult>& passes) {
  return std::ranges::any_of(passes, [](const PassResult& pass) {
    return std::ranges::any_of(pass.points, [](const PlannedPoint& planned) {
      return planned.point.engagement.side != CutSide::kAir;
    });
  });
}

PointFilter Compared(const std::vector<PassResult>& passes) {
  return [forces = MaterialIsKnown(passes)](const PlannedPoint& planned) {
    return planned.skip == Infeasibility::kNone && planned.point.kind == PointKind::kCut &&
           (!forces || planned.point.engagement.side != CutSide::kAir);
  };
}

}  // namespace millpose
