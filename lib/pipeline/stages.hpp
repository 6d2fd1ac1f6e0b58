// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "base/progress.hpp"

namespace millpose {

/// Wall time of one stage; for run.json and the user alone, never for results.
struct StageTime {
  std::string name;
  double seconds = 0;
};

/// Announces stages to a Progress and times them.
class Stages {
 public:
  explicit Stages(Progress& progress) : progress_(progress) {}

  /// `shown`: the name for who watches, where it says more.
  void Begin(const std::string& name, size_t total, const std::string& shown = {}) {
    times_.push_back({name, 0});
    start_ = std::chrono::steady_clock::now();
    progress_.Begin(shown.empty() ? name : shown, total);
  }
  void Advance(size_t count) { progress_.Advance(count); }
  void End(const std::string& outcome) {
    times_.back().seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    progress_.End(outcome);
  }
  const std::vector<StageTime>& times() const { return times_; }

 private:
  Progress& progress_;
  std::vector<StageTime> times_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace millpose
