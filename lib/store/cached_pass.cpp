// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/cached_pass.hpp"

#include <algorithm>

#include "store/value_reader.hpp"

namespace millpose {
namespace {

template <class Plan>
struct CachedPlan {
  QueryRecord asked;
  Plan plan;
};

template <class Plan>
void WritePlan(const CheckpointStore& checkpoints, const std::string& key, const CachedPlan<Plan>& kept) {
  checkpoints.Write(key, ValueBytes().Add(kept).bytes());
}

/// The plan that was kept under `key`, holds, and `fits`.
template <class Plan>
std::optional<Plan> ReadPlan(const CheckpointStore& checkpoints, const std::string& key, const World& world,
                             const Obstacles& obstacles, const std::function<bool(const Plan&)>& fits) {
  CachedPlan<Plan> kept;
  const auto read = [&](bool nothing_moved) {
    return checkpoints.Read(key, [&](const std::string& bytes) {
      kept = {};
      if (!ValueReader(bytes).Read(kept)) return false;
      const bool as_now = kept.asked.obstacles == obstacles;
      return (nothing_moved ? as_now : StillHolds(kept.asked, world, obstacles)) && fits(kept.plan);
    });
  };
  if (read(true)) return std::move(kept.plan);
  if (!read(false)) return std::nullopt;
  kept.asked.obstacles = obstacles;  // so that what has moved is looked at once
  WritePlan(checkpoints, key, kept);
  return std::move(kept.plan);
}

}  // namespace

bool IsObstacle(BodyClass body_class, Mount mount) {
  return (body_class == BodyClass::kFixture || body_class == BodyClass::kPlatform) &&
         (mount == Mount::kWorld || mount == Mount::kWorkpiece);
}

Obstacles ObstaclesOf(const Cell& cell) {
  Obstacles obstacles;
  for (const Body& body : cell.bodies)
    if (IsObstacle(body.body_class, body.mount)) obstacles[body.name] = HashOfValues(body);
  return obstacles;
}

Cell WithoutPlaces(Cell cell) {
  for (Body& body : cell.bodies) {
    if (!IsObstacle(body.body_class, body.mount)) continue;
    body.X_MG = Pose::Identity();
    body.shape = Sphere{0};
  }
  return cell;
}

bool StillHolds(const QueryRecord& asked, const World& world, const Obstacles& now) {
  std::vector<std::string> changed;
  for (const auto& [name, hash] : now) {
    const auto before = asked.obstacles.find(name);
    if (before == asked.obstacles.end()) return false;
    if (before->second != hash) changed.push_back(name);
  }
  if (asked.obstacles.size() != now.size()) return false;
  const auto met = [&](const std::string& name) {
    return std::find(asked.looks.met.begin(), asked.looks.met.end(), name) != asked.looks.met.end();
  };
  return std::none_of(changed.begin(), changed.end(), met) &&
         (changed.empty() || world.FarFrom(changed, asked.looks));
}

std::optional<PassResult> ReadPass(const CheckpointStore& checkpoints, const std::string& key,
                                   const World& world, const Obstacles& obstacles,
                                   const std::function<bool(const PassResult&)>& fits) {
  return ReadPlan(checkpoints, key, world, obstacles, fits);
}

void WritePass(const CheckpointStore& checkpoints, const std::string& key, const Obstacles& obstacles,
               Queries looks, const PassResult& plan) {
  WritePlan<PassResult>(checkpoints, key, {{obstacles, std::move(looks)}, plan});
}

std::optional<LinkMove> ReadLinkMove(const CheckpointStore& checkpoints, const std::string& key,
                                     const World& world, const Obstacles& obstacles,
                                     const std::function<bool(const LinkMove&)>& fits) {
  return ReadPlan(checkpoints, key, world, obstacles, fits);
}

void WriteLinkMove(const CheckpointStore& checkpoints, const std::string& key, const Obstacles& obstacles,
                   Queries looks, const LinkMove& gap) {
  WritePlan<LinkMove>(checkpoints, key, {{obstacles, std::move(looks)}, gap});
}

}  // namespace millpose
