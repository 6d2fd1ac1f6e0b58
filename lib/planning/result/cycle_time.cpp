// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/cycle_time.hpp"

#include <fmt/format.h>

#include <cmath>

namespace millpose {

std::string ClockText(double seconds) {
  const long long whole = std::llround(seconds);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

CycleTime& CycleTime::operator+=(const CycleTime& other) {
  cuts += other.cuts;
  approaches += other.approaches;
  gaps += other.gaps;
  stops += other.stops;
  return *this;
}

std::string TimeText(const CycleTime& time) {
  return fmt::format("{} (cuts {}, approaches {}, gaps {}, stops {})", ClockText(time.Total()),
                     ClockText(time.cuts), ClockText(time.approaches), ClockText(time.gaps),
                     ClockText(time.stops));
}

}  // namespace millpose
