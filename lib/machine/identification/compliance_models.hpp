// SPDX-License-Identifier: GPL-3.0-or-later
// What gives way besides the joints, as far as measurements can tell (docs/compliance-models.md).
#pragma once

#include <vector>

#include "machine/identification/identify.hpp"

namespace millpose {

/// What a model may have beside the springs of the joints.
struct ComplianceStep {
  enum class Kind { kTilting, kBase, kLostMotion, kPayload };

  Kind kind = Kind::kTilting;
  int link = 0;  ///< of kTilting, 1..6

  bool operator==(const ComplianceStep&) const = default;
};

/// A model of what gives way, and how well it foretells poses that it was not fitted to.
struct ComplianceModel {
  std::vector<ComplianceStep> steps;  ///< beside the springs, in the order of gain
  std::vector<Give> gives;            ///< of these, but for a payload: IdentifyOptions::beside
  size_t unknowns = 6;
  bool judged = false;     ///< else there are too few poses to foretell any
  double mean_square = 0;  ///< mm², of the displacements of each pose as the others foretell them
  double deviation = 0;    ///< standard deviation of that mean, mm²

  bool payload() const;
};

/// A step that no model has, as the poses do not tell it apart.
struct UntoldStep {
  ComplianceStep step;
  std::optional<Give> give;  ///< of it, that is not told
  std::string reason;
};

/// Models, each with the one before in it.
struct ComplianceModels {
  std::vector<ComplianceModel> tried;  ///< the joints' springs first
  std::vector<UntoldStep> untold;      ///< steps beyond the last one
  size_t least = 0;                    ///< foretells best
  size_t chosen = 0;  ///< the first within one standard deviation of the least: the simplest that will do
};

/// Springs in the joints; with that step more which leaves the least error, step by step: a link that tilts
/// about both axes across its joint's, a base that moves along all three axes, the gaps of the joints (of
/// those that the poses tell apart from the springs), a payload. Every pose is foretold from the others.
/// Models with something that the poses cannot tell apart are left out; the springs alone are tried with
/// fewer than kLeastPosesForModels.
ComplianceModels TryModels(const Arm& arm, const std::vector<LoadCase>& cases,
                           const IdentifyOptions& options);

inline constexpr size_t kLeastPosesForModels = 12;

}  // namespace millpose
