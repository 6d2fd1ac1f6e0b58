// SPDX-License-Identifier: GPL-3.0-or-later
// What one fixed rotation about the tool axis would have given: what any CAM system can program.
#pragma once

#include <stop_token>

#include "planning/external/stations.hpp"
#include "planning/ladder/step_bound.hpp"
#include "planning/links/retract.hpp"
#include "planning/pose/scorer.hpp"
#include "planning/result/fixed_comparison.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// What a rotation is held to, and how rotations are ranked.
struct FixedRotationOptions {
  double rotation_step = 0;     ///< rad
  StepBounds steps;             ///< of the joints between neighbouring points
  double swept_resolution = 0;  ///< mm
  bool worst_first = false;     ///< the least worst value wins; else the least sum
  GearModel gears = {};         ///< with which reversals are counted
  int finished_from = 0;        ///< in passes from this one on, which leave the face
  int threads = 1;
  std::stop_token stop;
  RetractOptions leave;  ///< of the ends of pieces, with the share of the clearances that the plan has there
};

/// `passes` with joint angles as planned, each at its station. Rotations lie on the grid of the ladder
/// search.
FixedComparison CompareWithFixed(const Stations& stations, const std::vector<PassResult>& passes,
                                 const FixedRotationOptions& options);

}  // namespace millpose
