// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

#include "base/progress.hpp"

namespace millpose {

/// Writes progress to stderr: on a terminal a bar that moves, else one line when a stage ends and one every
/// ten seconds while it runs. Called from many threads.
class TerminalProgress : public Progress {
 public:
  /// `bar`: stderr is a terminal.
  explicit TerminalProgress(bool bar) : bar_(bar) {}

  void Begin(std::string_view stage, size_t total) override;
  void Advance(size_t count) override;
  void End(std::string_view outcome) override;

 private:
  using Clock = std::chrono::steady_clock;
  std::string State(Clock::time_point now) const;
  void Show(Clock::time_point now);

  const bool bar_;
  std::mutex mutex_;
  std::string stage_;
  size_t done_ = 0, total_ = 0;
  Clock::time_point began_, shown_;
};

}  // namespace millpose
