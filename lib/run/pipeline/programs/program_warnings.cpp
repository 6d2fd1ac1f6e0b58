// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/programs/program_warnings.hpp"

#include "base/counted.hpp"
#include "program/path_speed.hpp"

namespace millpose {
namespace {

constexpr size_t kNamed = 5;  // points in a warning; all stand in summary.json

/// The planned point at which motion i ends, or to which it leads where it was inserted.
int PointOf(const MotionProgram& program, size_t i) {
  while (program.motions[i].point < 0 && i + 1 < program.motions.size() &&
         program.motions[i + 1].pass == program.motions[i].pass)
    ++i;
  return program.motions[i].point;
}

}  // namespace

PathSpeed EstimatePathSpeed(const MotionProgram& written, const std::string& controller,
                            const PathDynamics& dynamics, double wanted) {
  const SpeedEstimate estimate = EstimateSpeed(written, dynamics, wanted);
  PathSpeed speed{controller, estimate.lowest_share, {}};
  for (const SlowPlace& place : estimate.places)
    speed.slow.push_back({written.motions[place.motion].pass, PointOf(written, place.motion), place.feed,
                          place.speed, place.short_motion ? "motion" : "corner"});
  return speed;
}

std::string SpeedWarning(const PathSpeed& speed) {
  if (speed.slow.empty()) return {};
  std::vector<PathSpeed::Place> worst = speed.slow;
  std::ranges::stable_sort(worst, {}, [](const PathSpeed::Place& place) { return place.speed / place.feed; });
  std::vector<std::string> named;
  for (size_t i = 0; i < std::min(kNamed, worst.size()); ++i)
    named.push_back(fmt::format("pass {} point {}: {:.0f} of {:.0f} mm/min ({})", worst[i].pass,
                                worst[i].point, 60 * worst[i].speed, 60 * worst[i].feed,
                                worst[i].cause == "corner" ? "corner" : "short motion"));
  return fmt::format(
      "the feed is not held at {}, estimated: {}{}; at corners a larger path_tolerance_mm "
      "helps, where motions are short a larger spacing_mm of point_economy",
      Counted(worst.size(), "place", "places"), fmt::join(named, ", "), worst.size() > kNamed ? ", ..." : "");
}

size_t BytesOf(const ProgramFiles& files) {
  size_t bytes = 0;
  for (const auto& [name, text] : files) bytes += text.size();
  return bytes;
}

std::string MemoryWarning(const ProgramFiles& files, size_t memory) {
  const size_t bytes = BytesOf(files);
  if (memory == 0 || bytes <= memory) return {};
  return fmt::format(
      "all files together take {} kB, the controller's memory for programs holds "
      "program_memory_kbytes = {} kB; splitting into files does not help: give it the passes in "
      "several jobs, loaded one after the other, or leave out more points (path_tolerance_mm, "
      "point_economy)",
      bytes / 1000, memory / 1000);
}

}  // namespace millpose
