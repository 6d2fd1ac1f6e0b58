// SPDX-License-Identifier: GPL-3.0-or-later
// A part that its clamps bend: surface, raw part and tool path as they are then (docs/registration.md).
#pragma once

#include "geometry/registration/bending.hpp"
#include "job/inputs.hpp"
#include "toolpath/milling_point.hpp"

namespace millpose {

/// How the job's part is bent; null: it is not.
const PartBending* BendingOf(const JobSettings& job);

/// Triangles of the part or its stock as they are bent, to 1 µm; of a job without bending as they are.
/// Throws InputError for a part that is bent by more than the job allows, or so steeply that it is no small
/// bending.
Triangles BentPart(const JobSettings& job, const Triangles& part);
Triangles BentStock(const JobSettings& job, Triangles stock);

/// The same faces as they are before bending: what regions are stated of.
Mesh UnbentPart(const JobSettings& job, const Mesh& bent);

/// A tool path that was laid on the unbent part, in P: its points go with the part, and normal, feed and tool
/// axis turn with the surface (lead and tilt stay).
void CarryToBent(const PartBending& bending, Toolpath& toolpath);

}  // namespace millpose
