// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/kept_pass.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "pipeline/value_reader.hpp"

namespace millpose {
namespace {

struct KeptPass {
  Obstacles obstacles;
  Looks looks;
  std::string plan;  ///< Serialise(PassResult)
};

bool IsObstacle(const Body& body) {
  return (body.body_class == BodyClass::kFixture || body.body_class == BodyClass::kPlatform) &&
         (body.mount == Mount::kWorld || body.mount == Mount::kWorkpiece);
}

/// Whether the plan would be the same with the obstacles as they are now.
bool Holds(const KeptPass& kept, const World& world, const Obstacles& now) {
  std::vector<std::string> changed;
  for (const auto& [name, hash] : now) {
    const auto before = kept.obstacles.find(name);
    if (before == kept.obstacles.end()) return false;
    if (before->second != hash) changed.push_back(name);
  }
  if (kept.obstacles.size() != now.size()) return false;
  const auto met = [&](const std::string& name) {
    return std::find(kept.looks.met.begin(), kept.looks.met.end(), name) != kept.looks.met.end();
  };
  return std::none_of(changed.begin(), changed.end(), met) &&
         (changed.empty() || world.FarFrom(changed, kept.looks));
}

}  // namespace

Obstacles ObstaclesOf(const Cell& cell) {
  Obstacles obstacles;
  for (const Body& body : cell.bodies)
    if (IsObstacle(body)) obstacles[body.name] = HashOfValues(body);
  return obstacles;
}

Cell WithoutPlaces(Cell cell) {
  for (Body& body : cell.bodies) {
    if (!IsObstacle(body)) continue;
    body.X_MG = Pose::Identity();
    body.shape = Sphere{0};
  }
  return cell;
}

std::optional<PassResult> ReadPass(const CheckpointStore& checkpoints, const std::string& key,
                                   const World& world, const Obstacles& obstacles,
                                   const std::function<bool(const PassResult&)>& fits) {
  const std::optional<std::string> bytes = checkpoints.Read(key);
  KeptPass kept;
  if (!bytes || !ValueReader(*bytes).Read(kept) || !Holds(kept, world, obstacles)) return std::nullopt;
  try {
    PassResult plan = ParsePassResult(kept.plan, key);
    if (!fits(plan)) return std::nullopt;
    if (kept.obstacles != obstacles) {
      kept.obstacles = obstacles;
      checkpoints.Write(key, ValueBytes().Add(kept).bytes());
    }
    return plan;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void WritePass(const CheckpointStore& checkpoints, const std::string& key, const Obstacles& obstacles,
               Looks looks, const PassResult& plan) {
  checkpoints.Write(key, ValueBytes().Add(KeptPass{obstacles, std::move(looks), Serialise(plan)}).bytes());
}

}  // namespace millpose
