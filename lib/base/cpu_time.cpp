// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/cpu_time.hpp"

#include <atomic>
#include <ctime>

namespace millpose {
namespace {

std::array<std::atomic<int64_t>, kCpuParts> spent{};  // ns

int64_t Now(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

struct Current {
  CpuPart part = CpuPart::kOther;
  int64_t since = 0;
};
thread_local Current current;

/// Counts what the part so far has taken and begins the next. Outside of all timers nothing is counted.
CpuPart SwitchTo(CpuPart part) {
  const int64_t now = Now(CLOCK_THREAD_CPUTIME_ID);
  const CpuPart before = current.part;
  if (before != CpuPart::kOther) spent[static_cast<size_t>(before)] += now - current.since;
  current = {part, now};
  return before;
}

}  // namespace

CpuTimer::CpuTimer(CpuPart part) : outer_(SwitchTo(part)) {}
CpuTimer::~CpuTimer() { SwitchTo(outer_); }

std::array<double, kCpuParts> CpuSeconds() {
  std::array<double, kCpuParts> seconds{};
  for (size_t i = 0; i < kCpuParts; ++i) seconds[i] = 1e-9 * static_cast<double>(spent[i].load());
  return seconds;
}

double ProcessCpuSeconds() { return 1e-9 * static_cast<double>(Now(CLOCK_PROCESS_CPUTIME_ID)); }

}  // namespace millpose
