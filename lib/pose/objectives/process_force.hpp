// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pose/objective.hpp"

namespace millpose {

/// |c·F|, mm: how far the mean cutting force F moves the tip. Parameters in N, on the tool: `feed_N` along
/// the feed, `across_N` along axis × feed, `axial_N` along the tool axis towards the holder; at least one is
/// not 0. They come from the job's process section (docs/process-force.md) or are given directly.
class ProcessForce final : public Objective {
 public:
  explicit ProcessForce(const ObjectiveParameters& parameters);
  std::string Name() const override { return "process_force"; }
  std::string Unit() const override { return "mm"; }
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override;

 private:
  Eigen::Vector3d force_;  // along feed, across, axis, N
};

}  // namespace millpose
