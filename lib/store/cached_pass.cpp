// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/cached_pass.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "store/value_reader.hpp"

namespace millpose {
namespace {

struct CachedPlan {
  QueryRecord asked;
  std::string plan;  ///< Serialise() of it
};

void WritePlan(const CheckpointStore& checkpoints, const std::string& key, QueryRecord asked,
               std::string plan) {
  checkpoints.Write(key, ValueBytes().Add(CachedPlan{std::move(asked), std::move(plan)}).bytes());
}

/// Hands a plan that was kept under `key` and holds to `take`, which says whether it is one of what is asked
/// for.
bool ReadPlan(const CheckpointStore& checkpoints, const std::string& key, const World& world,
              const Obstacles& obstacles, const std::function<bool(const std::string&)>& take) {
  CachedPlan kept;
  const auto read = [&](bool nothing_moved) {
    return checkpoints.Read(key, [&](const std::string& bytes) {
      kept = {};
      if (!ValueReader(bytes).Read(kept)) return false;
      const bool as_now = kept.asked.obstacles == obstacles;
      if (nothing_moved ? !as_now : !StillHolds(kept.asked, world, obstacles)) return false;
      try {
        return take(kept.plan);
      } catch (const InputError&) {
        return false;
      }
    });
  };
  if (read(true)) return true;
  if (!read(false)) return false;
  // So that what has moved is looked at once.
  WritePlan(checkpoints, key, {obstacles, std::move(kept.asked.looks)}, std::move(kept.plan));
  return true;
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
  PassResult plan;
  const auto take = [&](const std::string& bytes) {
    plan = ParsePassResult(bytes, key);
    return fits(plan);
  };
  return ReadPlan(checkpoints, key, world, obstacles, take) ? std::optional(std::move(plan)) : std::nullopt;
}

void WritePass(const CheckpointStore& checkpoints, const std::string& key, const Obstacles& obstacles,
               Queries looks, const PassResult& plan) {
  WritePlan(checkpoints, key, {obstacles, std::move(looks)}, Serialise(plan));
}

std::optional<LinkMove> ReadLinkMove(const CheckpointStore& checkpoints, const std::string& key,
                                     const World& world, const Obstacles& obstacles,
                                     const std::function<bool(const LinkMove&)>& fits) {
  LinkMove gap;
  const auto take = [&](const std::string& bytes) {
    gap = ParseLinkMove(bytes, key);
    return fits(gap);
  };
  return ReadPlan(checkpoints, key, world, obstacles, take) ? std::optional(std::move(gap)) : std::nullopt;
}

void WriteLinkMove(const CheckpointStore& checkpoints, const std::string& key, const Obstacles& obstacles,
                   Queries looks, const LinkMove& gap) {
  WritePlan(checkpoints, key, {obstacles, std::move(looks)}, Serialise(gap));
}

}  // namespace millpose
