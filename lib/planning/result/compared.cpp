// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/compared.hpp"

namespace millpose {

PointFilter Compared(const std::vector<PassResult>& passes) {
  bool forces = false;
  for (const PassResult& pass : passes)
    for (const PlannedPoint& planned : pass.points)
      forces = forces || planned.point.engagement.side != CutSide::kAir;
  return [forces](const PlannedPoint& planned) {
    return planned.skip == Infeasibility::kNone && planned.point.kind == PointKind::kCut &&
           (!forces || planned.point.engagement.side != CutSide::kAir);
  };
}

}  // namespace millpose
