// SPDX-License-Identifier: GPL-3.0-or-later
// Planned passes and gaps as their checkpoints keep them. Their keys leave out where obstacles stand and what
// they are shaped like; so they are found again after a clamp was moved, and kept if the clamp made no
// difference to them.
#pragma once

#include <functional>
#include <map>
#include <optional>

#include "machine/collision/world.hpp"
#include "planning/result/plan_result.hpp"
#include "store/checkpoints.hpp"

namespace millpose {

/// Whether a body is one that may be moved or formed anew: a fixture or platform that stands still.
bool IsObstacle(BodyClass body_class, Mount mount);

/// Fixtures and platforms that stand still, by name: the hash of all that each of them is.
using Obstacles = std::map<std::string, std::string>;
Obstacles ObstaclesOf(const Cell& cell);

/// The cell with its obstacles' poses and shapes taken out.
Cell WithoutPlaces(Cell cell);

/// What was asked of a world, and where its obstacles stood then.
struct QueryRecord {
  Obstacles obstacles;
  Queries looks;
};

/// Whether all answers would be the same in `world`, whose obstacles are `now`: each is as it was, or no
/// answer told of it and, as it is now, none would.
bool StillHolds(const QueryRecord& asked, const World& world, const Obstacles& now);

/// The plan of `pass` that was kept under `key`, if there is one that `fits` and planning it anew in `world`,
/// whose obstacles are `obstacles`, would give the same (StillHolds). Where one of them has changed, the
/// checkpoint is written anew. The key names the pass, whose milling points are not kept a second time.
std::optional<PassResult> ReadPass(const CheckpointStore& checkpoints, const std::string& key,
                                   const World& world, const Obstacles& obstacles, const Pass& pass,
                                   const std::function<bool(const PassResult&)>& fits);

/// Keeps the plan of a pass that was planned in a world with these obstacles, and what was asked of it.
void WritePass(const CheckpointStore& checkpoints, const std::string& key, const Obstacles& obstacles,
               Queries looks, const Pass& pass, const PassResult& plan);

/// The same of gaps. Where the cell has external axes their keys hold all of it, and nothing is told of
/// looks.
std::optional<LinkMove> ReadLinkMove(const CheckpointStore& checkpoints, const std::string& key,
                                     const World& world, const Obstacles& obstacles,
                                     const std::function<bool(const LinkMove&)>& fits);
void WriteLinkMove(const CheckpointStore& checkpoints, const std::string& key, const Obstacles& obstacles,
                   Queries looks, const LinkMove& gap);

}  // namespace millpose
