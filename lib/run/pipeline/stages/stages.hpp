// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "base/free_memory.hpp"
#include "base/progress.hpp"

namespace millpose {

/// Wall time of one stage; for run.json and the user alone, never for results.
struct StageTime {
  std::string name;
  double seconds = 0;
};

/// Hands a Progress on and times its stages. What a stage's name has in brackets is for who watches alone.
class Stages final : public Progress {
 public:
  explicit Stages(Progress& progress) : progress_(progress) {}

  /// One that is running already goes on.
  void Begin(std::string_view stage, size_t total) override {
    std::string name(stage.substr(0, stage.find(" (")));
    if (running_ && times_.back().name == name) return;
    times_.push_back({std::move(name), 0});
    running_ = true;
    start_ = std::chrono::steady_clock::now();
    progress_.Begin(stage, total);
  }
  void Advance(size_t count) override { progress_.Advance(count); }
  void Percent(int percent) override { progress_.Percent(percent); }
  void End(std::string_view outcome) override {
    times_.back().seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    running_ = false;
    progress_.End(outcome);
    ReleaseFreeMemory();
  }
  const std::vector<StageTime>& times() const { return times_; }

 private:
  Progress& progress_;
  bool running_ = false;
  std::vector<StageTime> times_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace millpose
