// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "machine/motion/line.hpp"
#include "planning/pose/scorer.hpp"

namespace millpose {

/// Whether the cutter goes into the part where the planner may lean it; by default, and where nothing leans,
/// nowhere. At the nominal lean the whole tool path was looked at before (gouge.hpp).
class LeanGouges {
 public:
  LeanGouges() = default;
  LeanGouges(const Carrier& carrier, const PoseProblem& problem);

  /// How deep, mm, at a pose.
  double At(const Joints& q) const;
  /// The deepest on the straight way between two poses, their own left out.
  double Between(const Joints& from, const Joints& to) const;

 private:
  Carrier carrier_;
  std::shared_ptr<const LeanSurface> surface_;  ///< null: there is nothing to find
};

}  // namespace millpose
