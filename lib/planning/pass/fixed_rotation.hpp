// SPDX-License-Identifier: GPL-3.0-or-later
// What one fixed rotation about the tool axis would have given: what any CAM system can program.
#pragma once

#include <stop_token>

#include "planning/external/stations.hpp"
#include "planning/ladder/step_bound.hpp"
#include "planning/links/retract.hpp"
#include "planning/pass/fixed_table.hpp"
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

/// What a comparison finds out about one pass. It serves again while the pass, the problem, the options and
/// the answers about bodies stay the same.
struct FixedOfPass {
  std::vector<FixedTable> tables;  ///< by the plan's objective; then by |cF|, where that was asked for
  std::vector<char> free;  ///< per rotation and branch as in the tables: 0 not looked at, 1 free, 2 not
};

/// Where bodies are asked about for one pass, and what is known of it; the comparison adds to that.
struct FixedPass {
  Stations stations;
  FixedOfPass known;
};

/// `passes` with joint angles as planned, each at its station, and one of `of_passes` for each. Rotations lie
/// on the grid of the ladder search. What is known changes nothing but the time it takes.
FixedComparison CompareWithFixed(const Stations& stations, const std::vector<PassResult>& passes,
                                 const FixedRotationOptions& options, std::vector<FixedPass>& of_passes);

}  // namespace millpose
