// SPDX-License-Identifier: GPL-3.0-or-later
// Ways to mill a pass among which the job's face decides.
#pragma once

#include <optional>

#include "planning/pass/face_planner.hpp"
#include "planning/pass/face_sequence.hpp"
#include "run/pipeline/stages/plan_passes.hpp"

namespace millpose {

/// A pass run one way round.
struct FaceDirection {
  Pass made, placed;  ///< in P; in W
  PassResult planned;
  double attainable = 0;  ///< AttainableFace(), mm
  std::optional<PlannedFace> face;
};

/// One way to mill a pass.
struct FaceCandidateOfPass {
  size_t direction = 0;
  std::optional<FixedPose> fixed;  ///< else as PlanFace has it
  PassFace face;                   ///< pieces as they lie when the pass is run as it was given
};

/// Of a pass's pieces as they are planned.
PassFace FaceOf(const PlannedFace& planned);
double WorstOf(const PlannedFace& planned);  ///< largest displacement of a piece, mm
double MarksOf(const PlannedFace& planned);  ///< sum over pieces, mm

/// Of each pass the candidates that may stand beside any other: as PlanFace has them, and fixed rotations
/// whose displacements are less than `most` (mm), spread over their means.
std::vector<std::vector<size_t>> MixedCandidates(
    const std::vector<std::vector<FaceCandidateOfPass>>& candidates, double most);

}  // namespace millpose
