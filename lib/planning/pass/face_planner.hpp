// SPDX-License-Identifier: GPL-3.0-or-later
// Plans of passes for the least error of the face (docs/face-error.md).
#pragma once

#include "planning/external/stations.hpp"
#include "planning/pass/face_figures.hpp"
#include "planning/pass/face_sequence.hpp"
#include "planning/pass/pass_planner.hpp"

namespace millpose {

struct FacePlanOptions {
  GearModel gears;
  PathOptions path;
  RetractOptions leave;  ///< of the ends of segments
  /// mm: displacements up to this one count alike, as some pass of the job has one so large anyway.
  double limit = 0;
};

struct PlannedFace {
  PassResult pass;
  std::vector<FaceChoice> choices;  ///< by segment
};

/// A rotation of the ladder search's grid about the tool axis, and a branch.
struct FixedPose {
  int place = 0, branch = 0;
};

/// A pass at one rotation, on one branch.
struct FixedFace {
  FixedPose at;
  PassFace face;  ///< by segment
};

/// The largest displacement that each segment of a pass need not exceed, of all segments the largest, mm: as
/// planned, at the fixed rotation of the ladder search's grid that is best for it, interference left aside,
/// or where no rotation serves as a search finds it.
double AttainableFace(const Stations& stations, const PassResult& pass, const FacePlanOptions& options,
                      const Execution& execution);

/// A planned pass with each segment moved so that its largest displacement keeps to the limit and beneath
/// it the marks of gears that go over are least: as planned, at a fixed rotation, or as the search with the
/// gears' flanks as state finds it; where leans are free with the plan's leans or with the tool as it was
/// laid. Where nothing keeps to the limit the least displacement counts. No segment has a larger one, unless
/// beneath the limit, than at the best fixed rotation that serves it, or than it had. What is taken keeps
/// limits, joint steps and clearances as the pass does; the points stay. The same for any number of threads.
PlannedFace PlanFace(const Stations& stations, const PassResult& pass, const FacePlanOptions& options,
                     const Execution& execution);

/// Every rotation that serves all segments of a planned pass on one branch, interference left aside; where
/// leans are free with the tool as it was laid. Sorted by rotation, then branch.
std::vector<FixedFace> FixedFacesOf(const Stations& stations, const PassResult& pass,
                                    const FacePlanOptions& options, const Execution& execution);

/// The pass so; empty where that interferes or a segment cannot be left.
std::optional<PlannedFace> PlanFixedFace(const Stations& stations, const PassResult& pass,
                                         const FixedPose& at, const FacePlanOptions& options,
                                         const Execution& execution);

/// By what faces are judged in a cell, for the objective of its job.
FaceModel ModelOf(const Stations& stations, const GearModel& gears);

/// What each segment of a pass leaves.
std::vector<FaceChoiceFigures> FacesOf(const Stations& stations, const GearModel& gears,
                                       const PassResult& pass);

}  // namespace millpose
