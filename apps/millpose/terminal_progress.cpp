// SPDX-License-Identifier: GPL-3.0-or-later
#include "terminal_progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace millpose {
namespace {

constexpr size_t kBarWidth = 30;
constexpr std::chrono::milliseconds kBarInterval{100};
constexpr std::chrono::seconds kLineInterval{10};

double Seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

std::string Bar(double share) {
  const auto filled = static_cast<size_t>(share * kBarWidth);
  return '[' + std::string(filled, '#') + std::string(kBarWidth - filled, '.') + ']';
}

void Write(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace

void TerminalProgress::Begin(std::string_view stage, size_t total) {
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  done_ = 0;
  total_ = total;
  began_ = shown_ = Clock::now();
  if (bar_) Show(began_);
}

void TerminalProgress::Advance(size_t count) {
  const std::lock_guard lock(mutex_);
  done_ += count;
  const Clock::time_point now = Clock::now();
  if (bar_ ? now - shown_ >= kBarInterval : now - shown_ >= kLineInterval) Show(now);
}

void TerminalProgress::End(std::string_view outcome) {
  const std::lock_guard lock(mutex_);
  Write(fmt::format("{}{:<10} {:6.1f} s  {}\n", bar_ ? "\r\x1b[K" : "", stage_,
                    Seconds(Clock::now() - began_), outcome));
}

// "1200 of 5000 (24 %), 830/s, 5 s left"
std::string TerminalProgress::State(Clock::time_point now) const {
  const double elapsed = Seconds(now - began_);
  if (total_ == 0)
    return done_ > 0 ? fmt::format("{} done, {:.0f} s", done_, elapsed) : fmt::format("{:.0f} s", elapsed);
  const double rate = elapsed > 0 ? static_cast<double>(done_) / elapsed : 0;
  std::string state = fmt::format("{} of {} ({:.0f} %)", done_, total_,
                                  100.0 * static_cast<double>(done_) / static_cast<double>(total_));
  if (done_ > 0 && elapsed > 0.5)
    state += fmt::format(", {:.3g}/s, {:.0f} s left", rate,
                         static_cast<double>(total_ - std::min(done_, total_)) / rate);
  return state;
}

void TerminalProgress::Show(Clock::time_point now) {
  shown_ = now;
  if (!bar_) return Write(fmt::format("{:<10} {}\n", stage_, State(now)));
  const double share =
      total_ > 0 ? std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_)) : 0.0;
  Write(fmt::format("\r\x1b[K{:<10} {} {}", stage_, total_ > 0 ? Bar(share) : "", State(now)));
}

}  // namespace millpose
