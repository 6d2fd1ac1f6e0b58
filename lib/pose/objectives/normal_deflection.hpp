// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pose/objective.hpp"

namespace millpose {

/// nᵀcn, mm/N: displacement along the surface normal n under 1 N along it. Unlike λn it is a displacement
/// (docs/stiffness.md). No parameters.
class NormalDeflection final : public Objective {
 public:
  explicit NormalDeflection(const ObjectiveParameters& parameters);
  std::string Name() const override { return "normal_deflection"; }
  std::string Unit() const override { return "mm/N"; }
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;
};

}  // namespace millpose
