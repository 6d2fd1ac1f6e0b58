// SPDX-License-Identifier: GPL-3.0-or-later
// CPU time by part of the work, for the benchmark of a whole plan. Nothing that is planned may read it.
#pragma once

#include <array>
#include <cstdint>

namespace millpose {

/// Parts of a plan that share a stage.
enum class CpuPart : uint8_t { kOther, kOptima, kInterference };
inline constexpr size_t kCpuParts = 3;

/// While it lives, what this thread does counts as `part`; one inside another counts for itself alone.
class CpuTimer {
 public:
  explicit CpuTimer(CpuPart part);
  ~CpuTimer();
  CpuTimer(const CpuTimer&) = delete;
  CpuTimer& operator=(const CpuTimer&) = delete;

 private:
  CpuPart outer_;
};

/// Seconds that all timers of the process have counted so far, by part.
std::array<double, kCpuParts> CpuSeconds();

/// Seconds of CPU that the process has taken, user and system.
double ProcessCpuSeconds();

}  // namespace millpose
