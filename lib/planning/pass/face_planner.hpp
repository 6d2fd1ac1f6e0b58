// SPDX-License-Identifier: GPL-3.0-or-later
// Plans of passes for the least error of the face (docs/face-error.md).
#pragma once

#include "planning/external/stations.hpp"
#include "planning/pass/face_figures.hpp"
#include "planning/pass/pass_planner.hpp"

namespace millpose {

struct FaceOptions {
  GearModel gears;
  PathOptions path;
  RetractOptions leave;  ///< of the ends of pieces
};

/// A planned pass with each piece moved as leaves the least error of the face: as planned, at a fixed
/// rotation about the tool axis, or as a search with the gears' flanks as state finds it. None of its pieces
/// has a larger displacement than the best fixed rotation of the ladder search's grid that serves it, or
/// than it had. What is taken keeps limits, joint steps and clearances as the pass does; the points stay.
/// The same for any number of threads.
PassResult PlanFace(const Stations& stations, const PassResult& pass, const FaceOptions& options,
                    const Execution& execution);

/// By what faces are judged in a cell, for the objective of its job.
FaceModel ModelOf(const Stations& stations, const GearModel& gears);

/// What each piece of a pass leaves.
std::vector<FaceFigures> FacesOf(const Stations& stations, const GearModel& gears, const PassResult& pass);

}  // namespace millpose
