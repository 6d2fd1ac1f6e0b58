// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/external/stations.hpp"

#include "planning/pose/lean_problem.hpp"

namespace millpose {

Stations::Stations(const World& world, PoseProblem problem)
    : made_(std::make_shared<Made>(Station{world, std::move(problem)})) {
  made_->home = Mechanism(made_->at_zero.world.cell().external_axes).Home();
}

Stations Stations::AtOwnAxis() const {
  return HasLean(problem()) ? Stations(world(), millpose::AtOwnAxis(problem())) : *this;
}

const Station& Stations::At(const ExternalPosition& external) const {
  if (external.empty()) return made_->at_zero;
  const std::lock_guard lock(made_->mutex);
  std::shared_ptr<const Station>& station = made_->stations[external];
  if (!station) station = Own(external);
  return *station;
}

std::shared_ptr<const Station> Stations::Own(const ExternalPosition& external) const {
  const Cell& cell = world().cell();
  const Mechanism mechanism(cell.external_axes);
  PoseProblem moved = problem();
  moved.X_WB = mechanism.Moved(Carries::kRobot, external) * cell.X_WB;
  if (moved.lean && moved.lean->surface)
    moved.lean->surface = std::make_shared<const LeanSurface>(
        moved.lean->surface->At(mechanism.Moved(Carries::kWorkpiece, external) * cell.X_WP));
  for (SeriesCompliance& element : ExternalCompliances(mechanism, external, moved.X_WB))
    moved.compliances.push_back(std::move(element));
  return std::make_shared<const Station>(Station{world().At(external), std::move(moved)});
}

std::shared_ptr<const Station> Stations::Of(const PassResult& pass, size_t point) const {
  if (pass.points[point].external) return Own(*pass.points[point].external);
  return {made_, &At(pass.external)};
}

}  // namespace millpose
