// SPDX-License-Identifier: GPL-3.0-or-later
// Results of stages that are not worked out again where a stage is handed the same values.
#pragma once

#include <functional>

#include "base/process.hpp"
#include "pipeline/checkpoint_key.hpp"
#include "pipeline/checkpoints.hpp"
#include "pipeline/value_reader.hpp"

namespace millpose {

/// The key of a stage: the hash of the very values that it is handed, and of the program that runs it.
template <class... T>
std::string StageKey(const T&... handed) {
  return HashOfValues(ProgramId(), handed...);
}

/// What `make()` returns, or the same as `stage` left it under this key. `make` must read nothing that does
/// not stand in the key but what no result depends on (threads, stop).
template <class Result>
Result Kept(const CheckpointStore& store, const std::string& stage, const std::string& key,
            const std::function<Result()>& make) {
  if (const auto bytes = store.ReadStage(stage, key)) {
    Result result;
    if (ValueReader(*bytes).Read(result)) return result;
  }
  Result result = make();
  store.WriteStage(stage, key, ValueBytes().Add(result).bytes());
  return result;
}

}  // namespace millpose
