// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pose/objective.hpp"

namespace millpose {

/// aᵀca, mm/N: displacement along the tool axis a under 1 N along it, for drilling and plunging. No
/// parameters.
class Drilling final : public Objective {
 public:
  explicit Drilling(const ObjectiveParameters& parameters);
  std::string Name() const override { return "drilling"; }
  std::string Unit() const override { return "mm/N"; }
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;
};

}  // namespace millpose
