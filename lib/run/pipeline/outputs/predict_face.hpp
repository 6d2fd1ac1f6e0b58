// SPDX-License-Identifier: GPL-3.0-or-later
// The face that a planned job will leave (docs/face.md).
#pragma once

#include <optional>

#include "geometry/mesh/mesh.hpp"
#include "job/inputs.hpp"
#include "planning/external/stations.hpp"
#include "report/face_report.hpp"

namespace millpose {

struct FaceOptions {
  double spacing = 0;  ///< mm; 0: chosen for the region's area
  int draws = 100;
  std::optional<double> rotation;     ///< rad, of the fixed one beside it
  std::string fixed_in_the_way;       ///< why there is none
  std::optional<double> lost_motion;  ///< rad, of each of the arm's gears, in place of what the cell states
};

/// Throws InputError for a job that mills no face of a part.
void RequireFace(const JobInputs& inputs);

/// `mesh` of the part in P, `stations` as of Stations::AtOwnAxis. Throws InputError where the job mills no
/// face, or its tool reaches none of the region; Interrupted.
FaceReport PredictFace(const JobInputs& inputs, const PlanResult& plan, const Mesh& mesh,
                       const Stations& stations, const FaceOptions& options, const Execution& execution);

}  // namespace millpose
