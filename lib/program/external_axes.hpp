// SPDX-License-Identifier: GPL-3.0-or-later
// The axes beside the arm's six as a controller knows them: its names, its units, in which of them it counts.
#pragma once

#include "program/post.hpp"

namespace millpose {

/// Which of the settings' external axes a controller's axis is; empty for one that stands still.
std::optional<size_t> AxisOf(const PostSettings& settings, const ControllerAxis& axis);
/// What a program says of a controller's axis, mm or degrees, with the external axes at `external`.
double ValueOf(const PostSettings& settings, const ControllerAxis& axis, const ExternalPosition& external);
/// Whether that is degrees.
bool IsRotary(const PostSettings& settings, const ControllerAxis& axis);
/// Takes over what a program says of it; no effect on one that stands still.
void SetValue(const PostSettings& settings, const ControllerAxis& axis, double value,
              ExternalPosition& external);

/// `external` with all that the controller does not count in at 0.
ExternalPosition CoupledPart(const PostSettings& settings, const ExternalPosition& external);
/// The base frame X_BP, in the base as it stands with the external axes at `external`, as a controller states
/// it whose transformation carries the coupled axes: as it would be with those at 0, so that coupled axes
/// alone change nothing of it.
Pose AsCounted(const PostSettings& settings, const ExternalPosition& external, const Pose& X_BP);
/// The inverse.
Pose FromCounted(const PostSettings& settings, const ExternalPosition& external, const Pose& counted);

/// The controller's name of an axis that differs between two positions and is not coupled; empty: none.
std::string UncoupledMove(const PostSettings& settings, const ExternalPosition& from,
                          const ExternalPosition& to);
/// Why programs for the controller cannot have the cell's axis `axis` move along cuts; empty where they can:
/// the controller must count in it, or, where `joints` says that its programs are joint motions in all axes
/// together, need not.
std::string WhyNotAlongCuts(const PostSettings& settings, const std::string& controller,
                            const std::string& axis, bool joints);

/// Two frames that a program need not state one after the other: they differ by what arithmetic makes of one.
bool SameFrame(const Pose& a, const Pose& b);

/// Why the controller cannot be programmed with the cell's external axes, in one sentence; empty where it
/// can: each of them has its name there, and no other is named.
std::string WhyNotWithAxes(const PostSettings& settings, const std::string& controller);

/// The columns of a trajectory: all that the controller knows, by its names.
std::vector<ExternalColumn> ExternalColumns(const PostSettings& settings);

}  // namespace millpose
