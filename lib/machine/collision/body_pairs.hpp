// SPDX-License-Identifier: GPL-3.0-or-later
// What the bodies of a cell move with, and which pairs of them nobody ever looks at.
#pragma once

#include "machine/collision/cell.hpp"

namespace millpose {

/// The link that a body moves with; 0 for all that stand still in a pass.
int LinkOf(const Body& body);

inline constexpr int kNoCarrier = -1;  ///< moved by no external axis
/// The last axis that carries the robot, or the part.
int LastCarrier(const std::vector<ExternalAxis>& axes, Carries carried);
/// The external axis that a body moves with.
int CarrierOf(const std::vector<ExternalAxis>& axes, const Body& body);
/// The axis that carries an axis.
int CarrierOfAxis(const std::vector<ExternalAxis>& axes, int axis);

/// Carriages, and the base on one, that meet in a joint.
bool MeetInAxis(const std::vector<ExternalAxis>& axes, const Body& a, const Body& b);
/// Whether the arm's joints never move one against the other, or they are neighbouring links, which meet in
/// their joint.
bool MeetInArm(const Body& a, const Body& b);

/// Whether the cell names the two in excluded_pairs.
bool IsExcluded(const Cell& cell, const Body& a, const Body& b);
/// Whether no check looks at the two, whatever moves: they stand still to each other, meet in a joint, or the
/// cell excludes them.
bool NeverChecked(const Cell& cell, const Body& a, const Body& b);

}  // namespace millpose
