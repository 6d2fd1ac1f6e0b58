// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/cached_pass.hpp"

#include <algorithm>

#include "planning/result/pass_value.hpp"
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

/// A planned pass without the milling points that it was planned from, which whoever reads it has.
struct PassBesideLaid {
  PassResult plan;
  std::vector<int>
      laid;  ///< of every point: which of these it is, bit for bit; −1: its own stands in the plan
};

PassBesideLaid WithoutLaid(const PassResult& plan, const Pass& pass) {
  PassBesideLaid kept{plan, std::vector<int>(plan.points.size(), -1)};
  const std::vector<size_t> places = PlacesOf(plan, pass);
  const auto first = static_cast<size_t>(std::max(0, plan.opened_at));
  const auto bytes = [](const MillingPoint& point) { return ValueBytes().Add(point).bytes(); };
  for (size_t i = 0; i < places.size(); ++i) {
    const size_t laid = (first + i) % pass.points.size();
    MillingPoint& own = kept.plan.points[places[i]].point;
    if (bytes(own) != bytes(pass.points[laid])) continue;
    kept.laid[places[i]] = static_cast<int>(laid);
    own = {};
  }
  return kept;
}

std::optional<PassResult> WithLaid(PassBesideLaid kept, const Pass& pass) {
  if (kept.laid.size() != kept.plan.points.size()) return {};
  for (size_t i = 0; i < kept.laid.size(); ++i) {
    if (kept.laid[i] < 0) continue;
    if (static_cast<size_t>(kept.laid[i]) >= pass.points.size()) return {};
    kept.plan.points[i].point = pass.points[static_cast<size_t>(kept.laid[i])];
  }
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
                                   const World& world, const Obstacles& obstacles, const Pass& pass,
                                   const std::function<bool(const PassResult&)>& fits) {
  std::optional<PassResult> plan;
  const auto found =
      ReadPlan<PassBesideLaid>(checkpoints, key, world, obstacles, [&](const PassBesideLaid& kept) {
        plan = WithLaid(kept, pass);
        return plan && fits(*plan);
      });
  return found ? plan : std::nullopt;
}

void WritePass(const CheckpointStore& checkpoints, const std::string& key, const Obstacles& obstacles,
               Queries looks, const Pass& pass, const PassResult& plan) {
  WritePlan<PassBesideLaid>(checkpoints, key, {{obstacles, std::move(looks)}, WithoutLaid(plan, pass)});
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
