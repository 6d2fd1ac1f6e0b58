// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pose/objective.hpp"

namespace millpose {

/// σmax(cB), mm/N, with B a basis of the milling plane: the largest displacement of the tip in any direction
/// under 1 N in the plane. It bounds what milling forces do; eq. 23 does not (docs/stiffness.md). No
/// parameters.
class WorstInPlane final : public Objective {
 public:
  explicit WorstInPlane(const ObjectiveParameters& parameters);
  std::string Name() const override { return "worst_in_plane"; }
  std::string Unit() const override { return "mm/N"; }
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;
};

}  // namespace millpose
