// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/execution.hpp"
#include "base/units.hpp"
#include "planning/external/stations.hpp"
#include "planning/ladder/lifted_search.hpp"
#include "planning/ladder/step_bound.hpp"
#include "planning/links/retract.hpp"
#include "planning/pose/paper_formulation.hpp"
#include "planning/result/plan_result.hpp"
#include "toolpath/pass_ends.hpp"

namespace millpose {

/// How a pass is planned (design.md, "The planning of one pass").
struct PathOptions {
  double rotation_step = DegToRad(1);      ///< grid of the ladder search, rad
  StepBounds steps;                        ///< of the joints between neighbouring points, hard
  double max_lean_change = DegToRad(0.5);  ///< rad a mm of way: of lead and of tilt, where they are free
  double motion_share = 0.04;     ///< per rad² of joint motion, of the median optimum of the pass's points
  bool worst_first = false;       ///< the worst value of a pass first, then the sum (WorstThenSum)
  double smoothing_loss = 0.01;   ///< share of a piece's objective that smoothing may give up
  double max_deviation = 5;       ///< mm, of the tip half-way between points (BendLaw)
  double swept_resolution = 0.5;  ///< mm
  double overlap = 10;            ///< mm that the parts of a split pass share
  PassEnds ends;                  ///< their leads, without overrun
  double lead_spacing = 10;       ///< mm, of the leads' points
  GeneticOptions genetic;
  std::optional<PaperFormulationOptions> paper;  ///< in place of the genetic algorithm over the freedoms
  uint64_t seed = 1;
  std::optional<RetractOptions> leave;  ///< of the ends of pieces, with a free retract then (EndGuard)
  double lift_gain = 0;  ///< share of a pass's objective that a lift must gain; 0: no lifts but needed ones
  int max_lifts = 1;     ///< of a pass, up to kMostLifts

  LiftPrice Price() const {
    return {lift_gain > 0 ? static_cast<size_t>(max_lifts) : 0, lift_gain, worst_first};
  }
};

/// A pass along which external axes move, open, each point in W with them at its entry of `external`.
struct CoordinatedPass {
  const Stations& stations;
  const std::vector<ExternalPosition>& external;  ///< of each point of the pass
};

/// A pass to be planned, in W.
struct PassToPlan {
  const Pass& pass;
  int number = 0;          ///< in the tool path
  size_t first_point = 0;  ///< index of its first point in the job (random streams)
};

/// Plans one pass: own optima by both searches, ladder search with hard joint steps, lazy pruning of
/// interfering nodes, refinement, splits, smoothing. Where it has to be split between two points, its parts
/// overlap: the result then holds points more than once (WithOverlaps). Depends on nothing but its arguments;
/// the same result for any thread count. `execution` bounds its own parallelism and the memory of its
/// candidates; throws InputError where they need more.
PassResult PlanPass(const PoseProblem& problem, const World& world, const PassToPlan& pass,
                    const PathOptions& options, const Execution& execution);

/// The same where external axes move along the pass (docs/external-axes.md). Without lifts that pay; no
/// freedom leans the tool.
PassResult PlanPass(const CoordinatedPass& riding, const PassToPlan& pass, const PathOptions& options,
                    const Execution& execution);

}  // namespace millpose
