// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/choose_stations.hpp"

#include <map>
#include <tuple>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "cell/station_way.hpp"
#include "path/collision_pruner.hpp"
#include "path/retract.hpp"
#include "path/station_sequence.hpp"
#include "pipeline/assemble.hpp"
#include "pipeline/external_positions.hpp"
#include "pipeline/workpiece.hpp"
#include "plan/station.hpp"
#include "pose/candidate_table.hpp"

namespace millpose {
namespace {

constexpr size_t kSample = 7;  // points of a pass
constexpr size_t kLooks = 72;  // at a point on one branch for interference
constexpr double kRotationStep = DegToRad(5);
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
  if (const auto found = StationWay(stations.world(), home, 1).At(external)) return NearText(*found);
  if (const auto found = Checker(stations.At(external).world).At(home, Phase::kFree))
    return "at home " + NearText(*found);
  return "";
}

/// Some points of a pass, evenly over it, its ends among them.
Pass SampleOf(const Pass& pass) {
  Pass sample = pass;
  std::erase_if(sample.points, [](const MillingPoint& point) { return point.gouge > 0; });
  const size_t count = sample.points.size();
  if (count <= kSample) return sample;
  std::vector<MillingPoint> points;
  for (size_t i = 0; i < kSample; ++i) points.push_back(sample.points[i * (count - 1) / (kSample - 1)]);
  sample.points = std::move(points);
  return sample;
}

/// Scores passes at one station.
class Scorer {
 public:
  Scorer(const Station& station, const RetractOptions& leave)
      : station_(station),
        leave_(leave),
        carrier_{station.problem.arm, station.problem.X_WB, station.problem.X_FT},
        checker_(station.world) {}

  /// On the branch that serves it best: every point at its best free rotation by itself.
  StationScore Score(const Pass& sample) {
    std::vector<CandidateTable> tables;
    for (const MillingPoint& point : sample.points)
      tables.push_back(CandidateTable::OfStep(PointScorer(station_.problem, point, sample.rotation_reference),
                                              kRotationStep));
    StationScore best{sample.points.size(), 0, 0};
    for (size_t branch = 0; branch < 8; ++branch) {
      StationScore score;
      for (size_t t = 0; t < tables.size() && score.lost <= best.lost; ++t)
        Add(tables[t], branch, t == 0 || (!sample.closed && t + 1 == tables.size()), score);
      if (score < best) best = score;
    }
    return best;
  }

 private:
  void Add(const CandidateTable& table, size_t branch, bool end, StationScore& score) {
    std::vector<const CandidateTable::Entry*> entries;
    for (const CandidateTable::Entry& entry : table.entries())
      if (entry.branch == branch) entries.push_back(&entry);
    std::ranges::stable_sort(entries, {}, &CandidateTable::Entry::objective);
    for (size_t i = 0; i < std::min(entries.size(), kLooks); ++i) {
      const Joints& q = entries[i]->q;
      if (checker_.Blocked(q, Phase::kCutting) || (end && !CanLeave(checker_, carrier_, q, leave_))) continue;
      score.worst = std::max(score.worst, entries[i]->objective);
      score.sum += entries[i]->objective;
      return;
    }
    ++score.lost;
  }

  const Station& station_;
  const RetractOptions& leave_;
  Carrier carrier_;
  Checker checker_;
};

/// Of every station every pass.
std::vector<std::vector<StationScore>> ScoresOf(const JobInputs& inputs, const Stations& stations,
                                                const std::vector<ExternalPosition>& positions,
                                                const Toolpath& toolpath, const Execution& execution) {
  Toolpath samples;
  for (const Pass& pass : toolpath.passes) samples.passes.push_back(SampleOf(pass));
  const RetractOptions leave = MakeGapOptions(inputs.job).leave;
  std::vector<std::vector<StationScore>> scores(positions.size());
  ParallelFor(positions.size(), execution.Threads(), execution.stop, [&](size_t s) {
    const std::vector<ExternalPosition> here(samples.passes.size(), positions[s]);
    Scorer scorer(stations.At(positions[s]), leave);
    for (const Pass& pass : AtStations(inputs, samples, stations, here).passes) {
      CheckStop(execution.stop);
      scores[s].push_back(scorer.Score(pass));
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
    std::ranges::fill(choices.external, positions.front());
    if (const std::string blocked = BlockedBy(stations, positions.front()); !blocked.empty())
      choices.warnings.push_back(
          fmt::format("{}: with the external axes at {} {}", inputs.cell.file,
                      PositionText(stations.world().cell().external_axes, positions.front()), blocked));
    return choices;
  }
  positions = FreeOf(inputs, stations, std::move(positions));
  execution.progress.Begin("stations", positions.size());
  const auto scores = ScoresOf(inputs, stations, positions, toolpath, execution);
  StationSequence best;
  for (const std::vector<size_t>& group : Groups(axes, positions)) {
    std::vector<std::vector<StationScore>> own;
    for (const size_t s : group) own.push_back(scores[s]);
    StationSequence found = FindStationSequence(own, MakePathOptions(inputs.job).worst_first, kNext);
    for (std::vector<size_t>& pass : found.ranked)
      for (size_t& s : pass) s = group[s];
    if (best.ranked.empty() || found.IsBetter(best)) best = std::move(found);
  }
  for (size_t p = 0; p < toolpath.passes.size(); ++p) {
    choices.external[p] = positions[best.ranked[p].front()];
    for (size_t k = 1; k < best.ranked[p].size(); ++k)
      choices.elsewhere[p].push_back(positions[best.ranked[p][k]]);
  }
  execution.progress.End(fmt::format("{} stations looked at, {} changes", positions.size(), best.changes));
  return choices;
}

}  // namespace millpose
