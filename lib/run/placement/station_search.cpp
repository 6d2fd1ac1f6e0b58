// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/station_search.hpp"

#include <map>
#include <set>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "run/placement/place_search.hpp"
#include "run/placement/split.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

constexpr size_t kSeams = 63;  // places for seams, evenly over the path's length

/// Number `i` of Halton's sequence in a base: spreads evenly over 0..1 however many are taken.
double Halton(size_t i, size_t base) {
  double share = 1, value = 0;
  for (; i > 0; i /= base) {
    share /= static_cast<double>(base);
    value += share * static_cast<double>(i % base);
  }
  return value;
}

/// Where every point of a path lies along a direction.
std::vector<double> HeightsOf(const Toolpath& toolpath, const Eigen::Vector3d& along) {
  std::vector<double> heights;
  for (const Pass& pass : toolpath.passes)
    for (const MillingPoint& point : pass.points) heights.push_back(along.dot(point.position));
  return heights;
}

/// Whole millimetres: finer nobody marks them on a part.
std::vector<double> SeamsBetween(double least, double most) {
  std::set<double> seams;
  for (size_t i = 1; i <= kSeams; ++i) {
    const double seam = std::round(least + (most - least) * static_cast<double>(i) / (kSeams + 1));
    if (seam > least && seam < most) seams.insert(seam);
  }
  return {seams.begin(), seams.end()};
}

}  // namespace

void CheckStations(const std::vector<JobInputs>& inputs) {
  const JobSettings& job = inputs.front().job;
  if (!job.placement || !job.placement->stations) return;
  const auto refuse = [&](const std::string& why) {
    throw InputError({job.file}, "placement.stations: " + why);
  };
  if (inputs.size() > 1)
    refuse("a job of several operations is not split; give each operation as a job of its own");
  if (job.toolpath.share)
    refuse("toolpath.share says already what of the path is milled; leave one of both out");
  const std::vector<std::string> useless = job.toolpath.strategy->WithoutEffect();
  if (std::ranges::find(useless, "share") != useless.end())
    refuse(fmt::format("the path of strategy {} is not split", job.toolpath.strategy->Name()));
}

SplitRule SplitRuleOf(const JobInputs& inputs, const Toolpath& toolpath) {
  const StationSettings& settings = *inputs.job.placement->stations;
  SplitRule rule;
  if (settings.along) {
    rule.along = *settings.along;
  } else {
    double longest = -1;
    for (const Eigen::Vector3d axis :
         {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()}) {
      const auto [least, most] = std::ranges::minmax(HeightsOf(toolpath, axis));
      if (most - least > longest + 1e-6) longest = most - least, rule.along = axis;
    }
  }
  if (!std::ranges::all_of(toolpath.passes, &Pass::whole))
    rule.overlap = 2 * settings.error + inputs.job.toolpath.stepover;
  return rule;
}

StationSearch::StationSearch(const JobInputs& inputs, const PlaceSpace& space, const PlaceScorer& scorer,
                             Rater& rater, const Execution& execution)
    : inputs_(inputs),
      space_(space),
      scorer_(scorer),
      rater_(rater),
      execution_(execution),
      rule_(SplitRuleOf(inputs, scorer.operations().front().made.toolpath)),
      along_(HeightsOf(scorer.Sample(0), rule_.along)) {
  constexpr std::array<size_t, 6> kBases{2, 3, 5, 7, 11, 13};
  if (!along_.empty()) {
    const auto [least, most] = std::ranges::minmax(along_);
    seams_ = SeamsBetween(least, most);
  }
  std::set<std::array<double, 6>> known;
  for (int i = 1; i <= inputs.job.placement->places; ++i) {
    std::vector<double> shares;
    for (size_t d = 0; d < space.dimensions(); ++d)
      shares.push_back(Halton(static_cast<size_t>(i), kBases[d]));
    if (known.insert(KeyOf(space.At(shares))).second) shares_.push_back(std::move(shares));
  }
  rows_.resize(shares_.size());
  execution.progress.Begin("stations", shares_.size());
  ParallelFor(shares_.size(), execution.Threads(), execution.stop, [&](size_t i) {
    rows_[i] = scorer_.Points(space_.At(shares_[i]), {1, Silent(), execution_.stop});
    execution_.progress.Advance(1);
  });
  execution.progress.End(fmt::format("{} places", shares_.size()));
}

std::vector<SplitStation> StationSearch::Find(size_t count) {
  const std::vector<SplitPart> parts =
      BestSplit({.along = along_, .rows = rows_, .seams = seams_, .overlap = rule_.overlap}, count);
  const int places = std::max(1, inputs_.job.placement->places / static_cast<int>(count));
  std::vector<SplitStation> stations;
  execution_.progress.Begin(fmt::format("{} stations", count), parts.size() * static_cast<size_t>(places));
  for (const SplitPart& part : parts)
    stations.push_back(
        Improve({rule_.along, part.from, part.to, rule_.overlap}, shares_[part.place], places));
  execution_.progress.End("");
  return stations;
}

SplitStation StationSearch::Improve(const PathSection& share, const std::vector<double>& start, int places) {
  const Samples samples = scorer_.SampleOf(share);
  SplitStation station{share, {}};
  std::map<std::array<double, 6>, double> known;
  SearchShares(start, places, inputs_.job.seed, [&](std::span<const double> shares) {
    execution_.progress.Advance(1);
    const PoseSettings place = space_.At(shares);
    const std::array<double, 6> key = KeyOf(place);
    if (const auto seen = known.find(key); seen != known.end()) return seen->second;
    RatedPlace rated = rater_.Rate(scorer_.Score(place, samples, execution_));
    const double value = rated.value;
    if (known.empty() || value < station.rated.value) station.rated = std::move(rated);
    return known[key] = value;
  });
  return station;
}

}  // namespace millpose
