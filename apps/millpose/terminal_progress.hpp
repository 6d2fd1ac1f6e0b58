// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "base/progress.hpp"

namespace millpose {

/// How progress is written to stderr.
enum class ProgressForm {
  kBar,    ///< a bar that moves, for a terminal
  kLines,  ///< one line when a stage ends and one every ten seconds while it runs
  kJson    ///< one JSON object per line: when a stage begins, every second, when it ends
};

/// Writes progress to stderr, on a thread of its own: also while one unit of work takes long. Called from
/// many threads.
class TerminalProgress : public Progress {
 public:
  explicit TerminalProgress(ProgressForm form);

  void Begin(std::string_view stage, size_t total) override;
  void Advance(size_t count) override;
  void Percent(int percent) override;
  void End(std::string_view outcome) override;
  /// What the running stage is at, in words; until the next stage begins.
  void Doing(const std::string& what);
  /// Who knows how long the running stage will still take, s, better than its speed tells; empty: nobody.
  void LeftBy(std::function<std::optional<double>()> left);

 private:
  using Clock = std::chrono::steady_clock;
  /// How the stage stands; null where it cannot be known.
  struct Figures {
    double elapsed_s = 0;
    std::optional<double> share, per_s, left_s;
  };
  Figures Now(Clock::time_point now) const;
  std::string State(const Figures& figures) const;
  std::string Json(std::string_view event, const Figures& figures, std::string_view outcome) const;
  void Show(Clock::time_point now);
  void Watch(const std::stop_token& stop);

  const ProgressForm form_;
  std::mutex mutex_;
  std::string stage_, doing_;
  bool running_ = false;
  size_t done_ = 0, total_ = 0;
  std::function<std::optional<double>()> left_by_;
  std::optional<int> percent_;  // of a stage that cannot be counted
  Clock::time_point began_, shown_;
  std::jthread watch_;  // last: it ends before what it reads
};

}  // namespace millpose
