// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/lean_gouges.hpp"

namespace millpose {

LeanGouges::LeanGouges(const Carrier& carrier, const PoseProblem& problem) : carrier_(carrier) {
  if (problem.lean) surface_ = problem.lean->surface;
}

double LeanGouges::At(const Joints& q) const {
  if (!surface_) return 0;
  const Pose X_WT = carrier_.ToolPose(q);
  return surface_->Gouge(X_WT.translation(), X_WT.linear().col(2));
}

double LeanGouges::Between(const Joints& from, const Joints& to) const {
  if (!surface_) return 0;
  const Pose a = carrier_.ToolPose(from), b = carrier_.ToolPose(to);
  return surface_->GougeBetween(a.translation(), a.linear().col(2), b.translation(), b.linear().col(2));
}

}  // namespace millpose
