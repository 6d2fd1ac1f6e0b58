// SPDX-License-Identifier: GPL-3.0-or-later
#include "path/stations.hpp"

#include "pose/lean_problem.hpp"

namespace millpose {

Stations::Stations(World world, PoseProblem problem)
    : made_(std::make_shared<Made>(Station{std::move(world), std::move(problem)})) {
  made_->home = Mechanism(made_->at_zero.world.cell().external_axes).Home();
}

Stations Stations::AtOwnAxis() const {
  return HasLean(problem()) ? Stations(world(), millpose::AtOwnAxis(problem())) : *this;
}

const Station& Stations::At(const ExternalPosition& external) const {
  if (external.empty()) return made_->at_zero;
  const std::lock_guard lock(made_->mutex);
  std::unique_ptr<const Station>& station = made_->stations[external];
  if (station) return *station;
  World world = made_->at_zero.world.At(external);
  PoseProblem problem = made_->at_zero.problem;
  problem.X_WB = world.cell().X_WB;
  if (problem.lean && problem.lean->surface)
    problem.lean->surface = std::make_shared<const LeanSurface>(problem.lean->surface->At(world.cell().X_WP));
  const Mechanism mechanism(world.cell().external_axes);
  for (SeriesCompliance& element : ExternalCompliances(mechanism, external, problem.X_WB))
    problem.compliances.push_back(std::move(element));
  station = std::make_unique<const Station>(Station{std::move(world), std::move(problem)});
  return *station;
}

}  // namespace millpose
