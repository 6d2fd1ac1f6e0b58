// SPDX-License-Identifier: GPL-3.0-or-later
// Lead and tilt as freedoms of the pose search: docs/lean.md.
#pragma once

#include "base/error.hpp"
#include "pipeline/inputs.hpp"
#include "pose/scorer.hpp"
#include "surface/mesh.hpp"

namespace millpose {

/// Refuses ranges that the job's cutter cannot follow, each with its key.
void CheckLeanRanges(const JobInputs& inputs, std::vector<Problem>& problems);

/// Adds the freedoms of the job's ranges, and what bounds them. Does nothing where lead and tilt are numbers.
void AddLeanFreedoms(const JobInputs& inputs, const Mesh& mesh, const Pose& X_WP, PoseProblem* problem);

/// A planned point with the tool as the tool path was laid: what is cut away, and the mean force, follow from
/// that. In W.
MillingPoint AsLaid(const JobInputs& inputs, const MillingPoint& planned);

}  // namespace millpose
