// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of single points and steps, each recomputed from what the folder states.
#pragma once

#include <optional>

#include "tests/audit/folder.hpp"

namespace millpose::audit {

/// A point's objective from the judge's own compliance.
struct OwnObjective {
  Real value;
  Real scale;  ///< what an error is measured by: the value, or what it would be if no parts of it cancelled
};

/// Empty for chen2021, which is compared as an index, for names that the judge does not know, and where the
/// folder does not state the force that the pose was chosen for (leads, plans with skipped points).
std::optional<OwnObjective> ObjectiveOf(const Folder& folder, const Row& row, const Matrix3& c);

/// Whether the objective is of each point's own force.
bool NeedsForces(const Goal& goal);

/// Largest difference between a row of deflection.csv and c·F, as a share of |c·F|.
Real DeflectionError(const Deflected& stated, const Row& row, const Matrix3& c);

/// Where the cutter touches the surface, mm in W: the tip itself where the tool stands along its normal.
Vector3 ContactOf(const Folder& folder, const Row& row);

/// How far the lean of the tool's axis is from the one stated, rad.
Real LeanError(const Row& row);

/// Where arm and external axes are.
struct Posture {
  Angles angles;
  std::vector<Real> external = {};
};

/// How far the tip is from the middle of its straight way on the part when all joints have turned half of
/// theirs and all external axes have gone half of their way, mm.
Real HalfwayDeviation(const Setup& setup, const Posture& from, const Posture& to);

/// The same for a step to the next point with the rotation about the tool axis as it was.
Real HalfwayUnchanged(const Folder& folder, const Row& from, const Row& to);

/// What a step's deviation may be where `unchanged` is that with the rotation unchanged, mm: a quarter more
/// than it, a fifth by the search and the rest by smoothing.
Real MostHalfway(const Goal& goal, Real unchanged);

}  // namespace millpose::audit
