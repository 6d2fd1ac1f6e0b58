// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/stated_speeds.hpp"

#include "base/text.hpp"
#include "program/scanner.hpp"

namespace millpose {
namespace {

constexpr const char* kSpindleKey = "spindle";
constexpr const char* kFeedKey = "feed";

std::string PerMinute(double per_second) { return ShortestNumber(std::round(per_second * 60e3) / 1e3); }

std::vector<FedMotion> RunFrom(const MotionProgram& program, size_t first) {
  std::vector<FedMotion> run;
  for (size_t i = first; i < program.motions.size() && HasFeed(program.motions[i]); ++i) {
    const Motion &motion = program.motions[i], &before = program.motions[i - 1];
    run.push_back(
        {motion.feed, (motion.X_PT.translation() - before.X_PT.translation()).norm(), motion.exact});
  }
  return run;
}

double LargestFeed(std::span<const FedMotion> motions) {
  double largest = 0;
  for (const FedMotion& motion : motions) largest = std::max(largest, motion.feed);
  return largest;
}

double LengthOf(std::span<const FedMotion> motions) {
  double length = 0;
  for (const FedMotion& motion : motions) length += motion.length;
  return length;
}

}  // namespace

std::pair<size_t, size_t> ApproachAndRetract(std::span<const FedMotion> run) {
  size_t approach = 0, retract = 0;
  while (approach < run.size() && !run[approach].exact) ++approach;
  if (approach + 1 >= run.size()) return {0, 0};
  ++approach;
  while (retract < run.size() && !(retract > 0 && run[run.size() - 1 - retract].exact)) ++retract;
  if (approach + retract >= run.size()) retract = 0;
  return {approach, retract};
}

void StateSpeeds(MotionProgram& program) {
  StatedFeeds feeds;
  for (size_t i = 1; i < program.motions.size(); ++i) {
    if (!HasFeed(program.motions[i]) || HasFeed(program.motions[i - 1])) continue;
    const std::vector<FedMotion> run = RunFrom(program, i);
    const auto [first, last] = ApproachAndRetract(run);
    const std::span all(run);
    const auto approach = all.first(first), retract = all.last(last);
    feeds.approach = std::max(feeds.approach, LargestFeed(approach));
    feeds.retract = std::max(feeds.retract, LargestFeed(retract));
    feeds.cut = std::max(feeds.cut, LargestFeed(all.subspan(first, all.size() - first - last)));
    feeds.length = std::max({feeds.length, LengthOf(approach), LengthOf(retract)});
  }
  double spindle = 0;
  for (const ProgramEvent& event : program.events)
    if (event.kind == ProgramEvent::Kind::kSpindleOn) spindle = std::max(spindle, event.value);
  program.header.emplace_back(kSpindleKey, PerMinute(spindle) + " 1/min");
  program.header.emplace_back(
      kFeedKey, fmt::format("{} mm/min at most in cuts, {} in approaches, {} in retracts, each within {} mm",
                            PerMinute(feeds.cut), PerMinute(feeds.approach), PerMinute(feeds.retract),
                            std::ceil(feeds.length * 10) / 10));
}

std::optional<double> StatedSpindle(const MotionProgram& program) {
  const std::string value = HeaderValue(program, kSpindleKey);
  try {
    LineScanner scan(value, "", 0);
    const double speed = scan.ExpectNumber() / 60;
    scan.Expect("1/min");
    scan.ExpectEnd();
    return speed;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::optional<StatedFeeds> StatedFeedsOf(const MotionProgram& program) {
  const std::string value = HeaderValue(program, kFeedKey);
  try {
    LineScanner scan(value, "", 0);
    StatedFeeds feeds;
    feeds.cut = scan.ExpectNumber() / 60;
    scan.Expect("mm/min at most in cuts,");
    feeds.approach = scan.ExpectNumber() / 60;
    scan.Expect("in approaches,");
    feeds.retract = scan.ExpectNumber() / 60;
    scan.Expect("in retracts, each within");
    feeds.length = scan.ExpectNumber();
    scan.Expect("mm");
    scan.ExpectEnd();
    return feeds;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace millpose
