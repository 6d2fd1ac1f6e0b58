// SPDX-License-Identifier: GPL-3.0-or-later
// Where joints turn back in the cuts of the face, found by another route than the planner's: turning points
// of the whole way, from which swings are struck out until none is within the dead zone.
#pragma once

#include <functional>

#include "tests/audit/folder.hpp"

namespace millpose::audit {

/// The places (indices) at which a sequence turns back by more than `dead_zone`.
std::vector<size_t> TurningPlaces(const std::vector<Real>& way, Real dead_zone);

/// Output less input of a gear with a gap along a way, settled in the direction of its first swing beyond the
/// dead zone; the play operator without load.
std::vector<Real> Lag(const std::vector<Real>& way, Real width, Real dead_zone);

/// What does not agree with the folder: `count(where)` for a reversal that is stated and not found or found
/// and not stated, `mark(difference, where)` for heights and errors, mm.
struct ReversalFindings {
  std::function<void(const std::string& where)> count;
  std::function<void(Real difference, const std::string& where)> mark;
};
void AuditReversals(const Folder& folder, const ReversalFindings& findings);

}  // namespace millpose::audit
