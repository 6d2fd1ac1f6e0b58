// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/choose_stations.hpp"

#include <map>
#include <tuple>

#include "base/counted.hpp"
#include "base/error.hpp"
#include "base/parallel.hpp"
#include "job/assemble.hpp"
#include "job/external_positions.hpp"
#include "job/workpiece.hpp"
#include "machine/collision/station_path.hpp"
#include "planning/external/station_sequence.hpp"
#include "planning/links/retract.hpp"
#include "planning/result/station.hpp"
#include "run/pipeline/stages/moving_stations.hpp"
#include "run/pipeline/stages/station_sample.hpp"

namespace millpose {
namespace {

constexpr size_t kNext = 3;  // further stations of a pass

/// Every combination of the axes' values, the last axis fastest.
std::vector<ExternalPosition> Combined(const std::vector<AxisPositions>& axes) {
  std::vector<ExternalPosition> all{{}};
  for (const AxisPositions& axis : axes) {
    std::vector<ExternalPosition> longer;
    for (const ExternalPosition& position : all)
      for (const double value : axis.values) {
        longer.push_back(position);
        longer.back().push_back(value);
      }
    all = std::move(longer);
  }
  return all;
}

/// What stands in the way of a station itself, whatever is milled there.
std::string BlockedBy(const Stations& stations, const ExternalPosition& external) {
  const Joints& home = stations.world().cell().home;
  if (const auto found = StationPath(stations.world(), home, 1).At(external)) return NearText(*found);
  if (const auto found = Checker(stations.At(external).world).At(home, Phase::kFree))
    return "at home " + NearText(*found);
  return "";
}

/// A pass at one station: every point of the sample at its best free rotation by itself.
StationScore ScoreAt(const Station& station, const RetractOptions& leave, const Pass& sample) {
  Checker checker(station.world);
  std::vector<SampledPoint> points;
  for (size_t t = 0; t < sample.points.size(); ++t)
    points.emplace_back(station, checker, leave, sample.points[t], sample.rotation_reference,
                        t == 0 || (!sample.closed && t + 1 == sample.points.size()));
  return ScoreOf(points.size(), [&](size_t t, size_t branch) { return points[t].Best(branch); });
}

/// Of every station every pass.
std::vector<std::vector<StationScore>> ScoresOf(const JobInputs& inputs, const Stations& stations,
                                                const std::vector<ExternalPosition>& positions,
                                                const Toolpath& toolpath, const Execution& execution) {
  Toolpath samples;
  for (const Pass& pass : toolpath.passes) samples.passes.push_back(SampleOf(pass));
  const RetractOptions leave = MakeLinkMoveOptions(inputs.job).leave;
  std::vector<std::vector<StationScore>> scores(positions.size());
  ParallelFor(positions.size(), execution.Threads(), execution.stop, [&](size_t s) {
    const std::vector<ExternalCourse> here(samples.passes.size(), StandingAt(positions[s]));
    for (const Pass& pass : AtStations(inputs, samples, stations, here).passes) {
      CheckStop(execution.stop);
      scores[s].push_back(ScoreAt(stations.At(positions[s]), leave, pass));
    }
    execution.progress.Advance(1);
  });
  return scores;
}

/// Stations that differ in axes alone which each pass has its own position of.
std::vector<std::vector<size_t>> Groups(const std::vector<AxisPositions>& axes,
                                        const std::vector<ExternalPosition>& positions) {
  std::map<ExternalPosition, std::vector<size_t>> groups;
  for (size_t s = 0; s < positions.size(); ++s) {
    ExternalPosition key;
    for (size_t i = 0; i < axes.size(); ++i)
      if (!axes[i].per_pass) key.push_back(positions[s][i]);
    groups[key].push_back(s);
  }
  std::vector<std::vector<size_t>> all;
  for (auto& [key, group] : groups) all.push_back(std::move(group));
  return all;
}

/// The positions that are free; throws where none is.
std::vector<ExternalPosition> FreeOf(const JobInputs& inputs, const Stations& stations,
                                     std::vector<ExternalPosition> positions) {
  const std::string first = PositionText(stations.world().cell().external_axes, positions.front());
  std::string why;
  std::erase_if(positions, [&](const ExternalPosition& external) {
    std::string blocked = BlockedBy(stations, external);
    if (why.empty()) why = blocked;
    return !blocked.empty();
  });
  if (positions.empty())
    throw InputError({inputs.job.file},
                     fmt::format("external: none of the positions is free; at {}: {}", first, why));
  return positions;
}

/// The choices of a pass as they are ranked; where axes move in the first, the best one that stands comes
/// second.
std::vector<size_t> StandingSecond(const std::vector<CourseScore>& choices, std::vector<size_t> ranked) {
  const auto moves = [&](size_t c) { return choices[c].from != choices[c].to; };
  if (!moves(ranked.front())) return ranked;
  size_t best = choices.size();
  for (size_t c = 0; c < choices.size(); ++c)
    if (!moves(c) && (best == choices.size() || choices[c].score < choices[best].score)) best = c;
  std::erase(ranked, best);
  ranked.insert(ranked.begin() + 1, best);
  return ranked;
}

}  // namespace

StationChoices ChooseStations(const JobInputs& inputs, const Stations& stations, const Execution& execution,
                              const Toolpath& toolpath) {
  StationChoices choices;
  choices.external.resize(toolpath.passes.size());
  choices.elsewhere.resize(toolpath.passes.size());
  if (inputs.cell.external_axes.empty()) return choices;
  const std::vector<AxisPositions> axes = PositionsOf(inputs.job, inputs.cell);
  std::vector<ExternalPosition> positions = Combined(axes);
  if (positions.size() == 1) {
    std::ranges::fill(choices.external, StandingAt(positions.front()));
    if (const std::string blocked = BlockedBy(stations, positions.front()); !blocked.empty())
      choices.warnings.push_back(
          fmt::format("{}: with the external axes at {} {}", inputs.cell.file,
                      PositionText(stations.world().cell().external_axes, positions.front()), blocked));
    return choices;
  }
  positions = FreeOf(inputs, stations, std::move(positions));
  execution.progress.Begin("stations", positions.size());
  const auto scores = ScoresOf(inputs, stations, positions, toolpath, execution);
  const auto moving = ScoreMoving(inputs, {stations, axes, positions}, toolpath, execution);
  StationSequence best;
  std::vector<std::vector<CourseScore>> choices_of;  // what `best` chose from
  for (const std::vector<size_t>& group : Groups(axes, positions)) {
    std::vector<std::vector<CourseScore>> own(toolpath.passes.size());
    for (size_t p = 0; p < own.size(); ++p) {
      for (const size_t s : group) own[p].push_back({s, s, scores[s][p]});
      for (const CourseScore& course : moving[p])
        if (std::ranges::binary_search(group, course.from)) own[p].push_back(course);
    }
    StationSequence found = FindCourseSequence(own, MakePathOptions(inputs.job).worst_first, kNext);
    if (!best.ranked.empty() && !found.IsBetter(best)) continue;
    best = std::move(found);
    choices_of = std::move(own);
  }
  size_t moves = 0;
  for (size_t p = 0; p < toolpath.passes.size(); ++p) {
    const std::vector<size_t> ranked = StandingSecond(choices_of[p], best.ranked[p]);
    std::vector<ExternalCourse> courses;
    for (const size_t c : ranked)
      courses.push_back({positions[choices_of[p][c].from], positions[choices_of[p][c].to]});
    choices.external[p] = courses.front();
    choices.elsewhere[p].assign(courses.begin() + 1, courses.end());
    moves += courses.front().Moves();
  }
  execution.progress.End(fmt::format("{} stations looked at, {} changes{}", positions.size(), best.changes,
                                     moves > 0 ? ", axes move along " + CountedPasses(moves) : ""));
  return choices;
}

}  // namespace millpose
