// SPDX-License-Identifier: GPL-3.0-or-later
// Freedoms of the pose search that lean the tool, such as lead and tilt: docs/lean.md.
#pragma once

#include "base/error.hpp"
#include "geometry/mesh/mesh.hpp"
#include "job/inputs.hpp"
#include "planning/pose/scorer.hpp"

namespace millpose {

/// Refuses ranges that the job's cutter cannot follow, each with its key.
void CheckLeanRanges(const JobInputs& inputs, std::vector<Problem>& problems);

/// Sets what bounds the freedoms that lean the tool. Does nothing where none does.
void BoundLeans(const JobInputs& inputs, const Mesh& mesh, const Pose& X_WP, PoseProblem* problem);

/// A planned point with the tool as the tool path was laid: what is cut away, and the mean force, follow from
/// that. In W.
MillingPoint AsLaid(const JobInputs& inputs, const MillingPoint& planned);

}  // namespace millpose
