// SPDX-License-Identifier: GPL-3.0-or-later
// The courses of the tool's lean along a pass that the ladder search chooses between: docs/lean.md.
#pragma once

#include "planning/pass/pass_context.hpp"

namespace millpose {

/// Grid of the rotation in the ladder search, rad: coarser where leans multiply its nodes.
double RotationStep(const PassContext& context);

/// Which setting of the further freedoms (setting % CandidateTable::stride()) is the nominal one.
size_t NominalSetting(const PoseProblem& problem, const CandidateTable& table);

/// The leans that a pass may keep from its first point to its last: the nominal one first, then those that
/// promise most by the best candidates of each point.
std::vector<size_t> ChooseLeans(const PassContext& context);

/// The candidates of a point on these leans; the nominal one, course 0, on the grid that a pass without leans
/// has, so that whatever could be planned without them still can.
std::vector<NodeSeed> LeaningSeeds(const PassContext& context, size_t t, std::span<const size_t> leans);

/// With leans the table is coarse: where the genetic algorithm's answer lies lower than a point's own
/// optimum, the local optimum that it leads to takes its place.
void DescendInLeans(PassContext& context, size_t t);

/// The points that the bounds of steps go by: where freedoms lean the tool, the contacts, the tool upright.
std::vector<MillingPoint> StepPoints(const PoseProblem& problem, std::span<const MillingPoint> points);

/// Largest change of each lean between neighbouring points, rad: entry t from point t on, the last to the
/// first. Empty where nothing leans.
std::vector<double> LeanBounds(const PoseProblem& problem, double per_mm,
                               std::span<const MillingPoint> points);

/// Whether each lean changes by no more than `most` from one setting to another.
bool LeansWithin(const FreedomValues& from, const FreedomValues& to, double most);

}  // namespace millpose
