// SPDX-License-Identifier: GPL-3.0-or-later
// What a pass is planned in with the external axes somewhere (docs/external-axes.md).
#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "machine/collision/world.hpp"
#include "planning/pose/scorer.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose {

/// A cell whose base and part stand where the external axes have put them.
struct Station {
  World world;
  PoseProblem problem;  ///< what the external axes yield is among its compliances
};

/// All stations of a job, each made once. Safe to ask from several threads; copies share what was made.
class Stations {
 public:
  /// Both with the external axes at 0.
  Stations(const World& world, PoseProblem problem);

  /// Valid as long as any copy lives. One value for each external axis; empty where there is none.
  const Station& At(const ExternalPosition& external) const;
  /// The same, made for the caller alone: passes along which axes move have a station for every point.
  std::shared_ptr<const Station> Own(const ExternalPosition& external) const;
  /// What point `point` of a planned pass was planned in: Own where axes move along the pass, else At.
  std::shared_ptr<const Station> Of(const PassResult& pass, size_t point) const;
  /// The same with tool axes as points have them: the rotation is the only freedom (AtOwnAxis).
  Stations AtOwnAxis() const;
  /// Where the axes stand when programs start and end.
  const ExternalPosition& home() const { return made_->home; }
  /// With the external axes at 0.
  const World& world() const { return made_->at_zero.world; }
  const PoseProblem& problem() const { return made_->at_zero.problem; }

 private:
  struct Made {
    explicit Made(Station station) : at_zero(std::move(station)) {}

    Station at_zero;
    ExternalPosition home;
    std::mutex mutex;
    std::map<ExternalPosition, std::shared_ptr<const Station>> stations;
  };
  std::shared_ptr<Made> made_;
};

}  // namespace millpose
