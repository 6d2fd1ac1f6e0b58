// SPDX-License-Identifier: GPL-3.0-or-later
#include "terminal_progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/utf8.hpp"
#include "clean_output.hpp"

namespace millpose {
namespace {

constexpr size_t kBarWidth = 30, kLeastBar = 8;
constexpr double kLeastTime = 0.5;  // s before a speed is reported: earlier it is noise

std::chrono::milliseconds Interval(ProgressForm form) {
  switch (form) {
    case ProgressForm::kBar:
      return std::chrono::milliseconds(100);
    case ProgressForm::kLines:
      return std::chrono::seconds(10);
    case ProgressForm::kJson:
      break;
  }
  return std::chrono::seconds(1);
}

std::string Bar(double share, size_t width) {
  const auto filled = static_cast<size_t>(share * static_cast<double>(width));
  return '[' + std::string(filled, '#') + std::string(width - filled, '.') + ']';
}

// Of the terminal that stderr is; a longer line would wrap, and clearing it would leave its beginning.
size_t TerminalColumns() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

// The first characters of a text; each is taken to fill one column.
std::string FirstColumns(std::string_view text, size_t columns) {
  size_t bytes = 0;
  for (size_t i = 0; i < columns && bytes < text.size(); ++i)
    bytes += std::max<size_t>(1, Utf8Length(text.substr(bytes)));
  return std::string(text.substr(0, bytes));
}

// "passes     [####....] 1200 of 5000 (24 %), 830/s, 5 s left" in the columns that there are.
std::string BarLine(const std::string& stage, const std::optional<double>& share, const std::string& state) {
  const size_t columns = TerminalColumns() - 1;
  const size_t words = std::max<size_t>(stage.size(), 10) + state.size() + 4;  // blanks and brackets
  const size_t width = columns > words ? std::min(kBarWidth, columns - words) : 0;
  const std::string bar = share && width >= kLeastBar ? Bar(*share, width) + ' ' : "";
  return FirstColumns(fmt::format("{:<10} {}{}", stage, bar, state), columns);
}

std::string SpeedText(double per_s) {
  return per_s < 1000 ? fmt::format("{:.3g}/s", per_s) : fmt::format("{:.0f}/s", per_s);
}

// "40 s", "7 min", "2 h 10 min": an estimate has no more digits.
std::string SpanText(double seconds) {
  const long long minutes = std::llround(seconds / 60);
  if (seconds < 90) return fmt::format("{:.0f} s", seconds);
  if (minutes < 90) return fmt::format("{} min", minutes);
  return fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

void Write(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace

TerminalProgress::TerminalProgress(ProgressForm form) : form_(form) {
  try {
    watch_ = std::jthread([this](const std::stop_token& stop) { Watch(stop); });
  } catch (const std::system_error&) {  // no thread to be had: stages are told as they begin and end
  }
}

void TerminalProgress::Begin(std::string_view stage, size_t total) {
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  doing_.clear();
  running_ = true;
  done_ = 0;
  total_ = total;
  percent_.reset();
  began_ = shown_ = Clock::now();
  if (form_ == ProgressForm::kBar) Show(began_);
  if (form_ == ProgressForm::kJson) Write(Json("begin", Now(began_), {}));
}

void TerminalProgress::Advance(size_t count) {
  const std::lock_guard lock(mutex_);
  done_ += count;
}

void TerminalProgress::Percent(int percent) {
  const std::lock_guard lock(mutex_);
  percent_ = percent;
}

void TerminalProgress::Doing(const std::string& what) {
  const std::lock_guard lock(mutex_);
  doing_ = what;
}

void TerminalProgress::LeftBy(std::function<std::optional<double>()> left) {
  const std::lock_guard lock(mutex_);
  left_by_ = std::move(left);
}

void TerminalProgress::End(std::string_view outcome) {
  const std::lock_guard lock(mutex_);
  running_ = false;
  const Figures figures = Now(Clock::now());
  if (form_ == ProgressForm::kJson) return Write(Json("end", figures, outcome));
  if (form_ == ProgressForm::kBar) ClearLine();
  Write(fmt::format("{:<10} {:6.1f} s  {}\n", stage_, figures.elapsed_s, outcome));
}

TerminalProgress::Figures TerminalProgress::Now(Clock::time_point now) const {
  Figures figures;
  figures.elapsed_s = std::chrono::duration<double>(now - began_).count();
  const auto done = static_cast<double>(done_);
  if (percent_) figures.share = *percent_ / 100.0;
  if (total_ > 0) figures.share = std::min(1.0, done / static_cast<double>(total_));
  if (done_ > 0 && figures.elapsed_s > kLeastTime) figures.per_s = done / figures.elapsed_s;
  if (left_by_)
    figures.left_s = left_by_();
  else if (total_ > 0 && figures.per_s)
    figures.left_s = static_cast<double>(total_ - std::min(done_, total_)) / *figures.per_s;
  return figures;
}

// "1200 of 5000 (24 %), 830/s, 5 s left"
std::string TerminalProgress::State(const Figures& figures) const {
  if (!figures.share)
    return fmt::format("{}{:.0f} s", done_ > 0 ? fmt::format("{} done, ", done_) : "", figures.elapsed_s);
  if (percent_) return fmt::format("{} %, {:.0f} s", *percent_, figures.elapsed_s);
  std::string state = fmt::format("{} of {} ({:.0f} %)", done_, total_, 100 * *figures.share);
  if (left_by_)
    state += figures.left_s ? ", about " + SpanText(*figures.left_s) + " left" : ", time left not known yet";
  else if (figures.left_s)
    state += fmt::format(", {}, {:.0f} s left", SpeedText(*figures.per_s), *figures.left_s);
  if (!doing_.empty()) state += ": " + doing_;
  return state;
}

std::string TerminalProgress::Json(std::string_view event, const Figures& figures,
                                   std::string_view outcome) const {
  using Value = nlohmann::ordered_json;
  const auto number = [](const std::optional<double>& value) { return value ? Value(*value) : Value(); };
  const Value line{{"event", event},
                   {"stage", stage_},
                   {"done", done_},
                   {"total", total_ > 0 ? Value(total_) : Value()},
                   {"share", number(figures.share)},
                   {"per_s", number(figures.per_s)},
                   {"left_s", number(figures.left_s)},
                   {"elapsed_s", figures.elapsed_s},
                   {"doing", doing_.empty() ? Value() : Value(doing_)},
                   {"outcome", event == "end" ? Value(outcome) : Value()}};
  return line.dump(-1, ' ', false, Value::error_handler_t::replace) + '\n';
}

void TerminalProgress::Show(Clock::time_point now) {
  shown_ = now;
  const Figures figures = Now(now);
  if (form_ == ProgressForm::kJson) return Write(Json("running", figures, {}));
  if (form_ == ProgressForm::kLines) return Write(fmt::format("{:<10} {}\n", stage_, State(figures)));
  ClearLine();
  Write(BarLine(stage_, figures.share, State(figures)));
}

void TerminalProgress::Watch(const std::stop_token& stop) {
  std::condition_variable_any changed;
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    const Clock::time_point now = Clock::now();
    if (running_ && now - shown_ >= Interval(form_)) Show(now);
    changed.wait_for(lock, stop, Interval(ProgressForm::kBar), [] { return false; });
  }
}

}  // namespace millpose
