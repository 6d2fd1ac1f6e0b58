// SPDX-License-Identifier: GPL-3.0-or-later
// A planned pass as its checkpoint keeps it. Its key leaves out where obstacles stand and what they are
// shaped like; so a pass is found again after a clamp was moved, and kept if the clamp made no difference to
// it.
#pragma once

#include <functional>
#include <map>
#include <optional>

#include "cell/world.hpp"
#include "pipeline/checkpoints.hpp"
#include "plan/plan_result.hpp"

namespace millpose {

/// Fixtures and platforms that stand still, by name: the hash of all that each of them is.
using Obstacles = std::map<std::string, std::string>;
Obstacles ObstaclesOf(const Cell& cell);

/// The cell with its obstacles' poses and shapes taken out.
Cell WithoutPlaces(Cell cell);

/// The pass that was kept under `key`, if there is one that `fits` and planning it anew in `world`, whose
/// obstacles are `obstacles`, would give the same: each obstacle is as it was, or no answer about the pass
/// told of it and, as it is now, none would (Looks). Where the latter, the checkpoint is written anew.
std::optional<PassResult> ReadPass(const CheckpointStore& checkpoints, const std::string& key,
                                   const World& world, const Obstacles& obstacles,
                                   const std::function<bool(const PassResult&)>& fits);

/// Keeps a pass that was planned in a world with these obstacles, and what was asked of it.
void WritePass(const CheckpointStore& checkpoints, const std::string& key, const Obstacles& obstacles,
               Looks looks, const PassResult& plan);

}  // namespace millpose
