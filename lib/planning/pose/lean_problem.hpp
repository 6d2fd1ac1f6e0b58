// SPDX-License-Identifier: GPL-3.0-or-later
// Pose problems whose freedoms lean the tool axis, and the points of their tool paths.
#pragma once

#include "planning/pose/scorer.hpp"

namespace millpose {

/// Whether some freedom leans the tool axis.
bool HasLean(const PoseProblem& problem);

/// The problem with the rotation as its only freedom: tool axes as the points have them. A point of a plan
/// has the axis that it was planned with.
PoseProblem AtOwnAxis(PoseProblem problem);

/// All freedoms at their nominal values, the first at `rotation`.
FreedomValues NominalFreedoms(const PoseProblem& problem, double rotation = 0);
/// Whether all but the first are at their nominal values.
bool IsNominalLean(const PoseProblem& problem, const FreedomValues& freedoms);

/// The tool on a contact as the freedoms lean it.
ToolStance StanceAt(const PoseProblem& problem, const CutterContact& contact,
                    std::span<const double> freedoms);
/// What the cutter touches at a point, whatever its lean; needs PoseProblem::lean.
CutterContact ContactOf(const PoseProblem& problem, const MillingPoint& point);
/// The point with the tool leaned about its contact as the freedoms say, or as the tool path was laid.
MillingPoint AtLean(const PoseProblem& problem, const MillingPoint& point, const FreedomValues& freedoms);
MillingPoint AtNominalLean(const PoseProblem& problem, const MillingPoint& point);
/// The point with the tool standing along the normal on its contact.
MillingPoint Upright(const PoseProblem& problem, const MillingPoint& point);

}  // namespace millpose
