// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pose/objective.hpp"

namespace millpose {

/// 1/μ = λτ1/λτ2 ≥ 1: how slim the section of the ellipsoid with the milling plane is (Chen 2021, 4.1, where
/// μ is to be large). It says nothing about how stiff the pose is. No parameters.
class Isotropy final : public Objective {
 public:
  explicit Isotropy(const ObjectiveParameters& parameters);
  std::string Name() const override { return "isotropy"; }
  std::string Unit() const override { return "1"; }
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;
};

}  // namespace millpose
