// SPDX-License-Identifier: GPL-3.0-or-later
// The motions of arm and external axes that a folder states: along its cuts and between them.
#pragma once

#include "tests/audit/laws.hpp"
#include "tests/audit/programs.hpp"

namespace millpose::audit {

/// A straight motion in joint space and what it is for.
struct JointMotion {
  Angles from, to;
  bool cutting;
  std::string name;
  std::vector<Real> external = {};                ///< where the external axes stand
  std::optional<std::vector<Real>> move_to = {};  ///< they go evenly there meanwhile
};

std::vector<JointMotion> CutMotions(const std::vector<Cut>& cuts);

/// All motions of a program in joint space that are not cuts; approach and retract may have the cutter in
/// its cut.
std::vector<JointMotion> LinkMotions(const std::vector<Target>& targets, const std::vector<Cut>& cuts);

/// The same from plan.cbor.gz, for a folder without a program that is in joint space throughout.
std::vector<JointMotion> PlannedLinkMotions(const Folder& folder, const std::vector<Cut>& cuts);

}  // namespace millpose::audit
