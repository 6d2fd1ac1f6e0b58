// SPDX-License-Identifier: GPL-3.0-or-later
// Results of stages that are not worked out again where a stage is handed the same values.
#pragma once

#include <functional>
#include <optional>

#include "base/process.hpp"
#include "planning/external/stations.hpp"
#include "store/cached_pass.hpp"
#include "store/checkpoint_key.hpp"
#include "store/checkpoints.hpp"
#include "store/value_reader.hpp"

namespace millpose {

/// The key of a stage: the hash of the very values that it is handed, and of the program that runs it.
template <class... T>
std::string StageKey(const T&... handed) {
  return HashOfValues(ProgramId(), handed...);
}

/// What `make()` returns, or the same as `stage` left it under this key. `make` must read nothing that does
/// not stand in the key but what no result depends on (threads, stop).
template <class Result>
Result Cached(const CheckpointStore& store, const std::string& stage, const std::string& key,
              const std::function<Result()>& make) {
  Result result;
  if (store.ReadStage(stage, key, [&](const std::string& bytes) {
        result = {};
        return ValueReader(bytes).Read(result);
      }))
    return result;
  result = make();
  store.WriteStage(stage, key, ValueBytes().Add(result).bytes());
  return result;
}

/// What a stage made, and what it asked the cell's world meanwhile.
template <class Result>
struct MadeInWorld {
  QueryRecord asked;
  Result result;
};

/// What `stage` left under this key, if no answer would be another now (StillHolds).
template <class Result>
std::optional<MadeInWorld<Result>> ReadInWorld(const CheckpointStore& store, const std::string& stage,
                                               const std::string& key, const World& world,
                                               const Obstacles& obstacles) {
  MadeInWorld<Result> kept;
  if (store.ReadStage(stage, key, [&](const std::string& bytes) {
        kept = {};
        return ValueReader(bytes).Read(kept) && StillHolds(kept.asked, world, obstacles);
      }))
    return kept;
  return std::nullopt;
}

/// Cached(), for stages that ask the cell's world: what they made is found again after an obstacle has moved
/// if no answer would be another (StillHolds). The world is no part of their keys; where the cell has
/// external axes, it is as it is. `make` asks the stations that it is given and no others.
template <class Result>
Result CachedInWorld(const CheckpointStore& store, const std::string& stage, const std::string& key,
                     const Stations& stations, const std::function<Result(const Stations&)>& make) {
  const World& world = stations.world();
  const Cell& cell = world.cell();
  if (!cell.external_axes.empty())
    return Cached<Result>(store, stage, StageKey(key, HashOfValues(cell)), [&] { return make(stations); });
  const std::string own = StageKey(key, HashOfValues(WithoutPlaces(cell)));
  const Obstacles obstacles = ObstaclesOf(cell);
  if (auto kept = ReadInWorld<Result>(store, stage, own, world, obstacles)) return std::move(kept->result);
  const auto looks = std::make_shared<QueryLog>();
  MadeInWorld<Result> made;
  made.result = make(Stations(world.Recording(looks), stations.problem()));
  made.asked = {obstacles, looks->Collected()};
  store.WriteStage(stage, own, ValueBytes().Add(made).bytes());
  return std::move(made.result);
}

}  // namespace millpose
