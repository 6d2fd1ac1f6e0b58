// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/bend_law.hpp"

#include "planning/ladder/edge_kernel.hpp"

namespace millpose {

Joints BendLaw::UnchangedStep(size_t t, const FreedomValues& freedoms, int branch, const Joints& q) const {
  const Candidate beside = scorers_[(t + 1) % scorers_.size()].ScoreOne(freedoms, branch);
  if (beside.obstacle == Infeasibility::kUnreachable) return Joints::Zero();
  return (beside.q - q).unaryExpr(&WrapToPi);
}

}  // namespace millpose
