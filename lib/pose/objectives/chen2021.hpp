// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pose/objective.hpp"

namespace millpose {

/// Chen 2021 eq. 23: f = w1·λτ2 + w2·λn, mm/N, of the ellipsoid of the linear compliance c at the stiffness
/// origin. λτ2 is the smaller semi-axis of its section with the milling plane (eq. 19), λn its radius along
/// the plane's normal (eq. 21). Parameters w1, w2 ≥ 0, default 0.5 each (they reproduce the paper's optimum).
///
/// With `reference_t2` and `reference_n` (mm/N, both or none) the radii are divided by them first, so that
/// the weights are shares of the two: f = w1·λτ2/reference_t2 + w2·λn/reference_n, without unit.
class Chen2021 final : public Objective {
 public:
  explicit Chen2021(const ObjectiveParameters& parameters);
  std::string Name() const override { return "chen2021"; }
  std::string Unit() const override { return normalised_ ? "1" : "mm/N"; }
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;

 private:
  double w1_, w2_;
  bool normalised_;
};

}  // namespace millpose
