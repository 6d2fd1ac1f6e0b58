// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/fewest_missing.hpp"

#include <algorithm>
#include <limits>

#include "base/parallel.hpp"

namespace millpose {
namespace {

constexpr size_t kEvery = 16;  // points of a pass of which one is looked at for every rotation
constexpr unsigned kAllLanes = (1u << kLanes) - 1;

class MissingSearch {
 public:
  MissingSearch(const Stations& stations, std::span<const PassResult* const> passes, const FixedTable& grid,
                int threads, std::stop_token stop)
      : stations_(stations),
        passes_(passes),
        grid_(grid),
        threads_(threads),
        stop_(std::move(stop)),
        missing_(passes.size(), std::vector<std::vector<size_t>>(grid.rotations)),
        counts_(grid.rotations, 0) {}

  MissingPoints Run() {
    std::vector<size_t> open;  // first rotations of blocks of which not all points have been looked at
    for (size_t r = 0; r < grid_.rotations; r += kLanes) open.push_back(r);
    LookAt(open, [](size_t i) { return i % kEvery == 0; });
    Rank best{std::numeric_limits<size_t>::max(), 0};
    for (size_t batch = 1; !open.empty(); batch *= 2) {
      std::ranges::sort(open, {}, [&](size_t block) { return RankOf(block); });
      while (!open.empty() && best < RankOf(open.back())) open.pop_back();
      const std::vector<size_t> next(open.begin(), open.begin() + std::min(batch, open.size()));
      open.erase(open.begin(), open.begin() + next.size());
      LookAt(next, [](size_t i) { return i % kEvery != 0; });
      for (const size_t block : next) best = std::min(best, RankOf(block));
    }
    MissingPoints found{best.second, best.first, {}};
    for (auto& of_pass : missing_) {
      std::ranges::sort(of_pass[found.rotation]);
      found.of_pass.push_back(std::move(of_pass[found.rotation]));
    }
    return found;
  }

 private:
  using Rank = std::pair<size_t, size_t>;  ///< points missing as far as they were looked at, and the rotation

  /// That of the best rotation of a block; it only grows with the points that are looked at.
  Rank RankOf(size_t block) const {
    Rank least{std::numeric_limits<size_t>::max(), 0};
    for (size_t r = block; r < std::min(block + kLanes, grid_.rotations); ++r)
      least = std::min(least, Rank{counts_[r], r});
    return least;
  }

  /// Looks at those planned points of every pass, counted from 0, that `wanted` says so of.
  void LookAt(const std::vector<size_t>& blocks, const std::function<bool(size_t)>& wanted) {
    ParallelFor(blocks.empty() ? 0 : passes_.size(), threads_, stop_, [&](size_t pass) {
      const PlannedIn in(stations_, *passes_[pass]);
      size_t i = 0;
      for (size_t t = 0; t < passes_[pass]->points.size(); ++t) {
        if (passes_[pass]->points[t].skip == Infeasibility::kNone && wanted(i++))
          LookAtPoint(in, pass, t, blocks);
      }
    });
    for (size_t r = 0; r < counts_.size(); ++r) {
      counts_[r] = 0;
      for (const auto& of_pass : missing_) counts_[r] += of_pass[r].size();
    }
  }

  void LookAtPoint(const PlannedIn& in, size_t pass, size_t t, const std::vector<size_t>& blocks) {
    CheckStop(stop_);
    const PlannedPoint& planned = in.pass.points[t];
    const PointScorer scorer(in.At(t).problem, planned.point, in.pass.rotation_reference);
    for (const size_t block : blocks) {
      const unsigned posed = LanesWithPose(scorer, planned.branch & 3, block);
      for (size_t l = 0; l < kLanes && block + l < grid_.rotations; ++l)
        if ((posed >> l & 1u) == 0) missing_[pass][block + l].push_back(t);
    }
  }

  /// Which of the eight rotations have a pose. The arm's branches one after the other, that of the plan
  /// first: mostly it has all of them.
  unsigned LanesWithPose(const PointScorer& scorer, int first_branch, size_t block) const {
    const std::vector<double> values = ValuesOfBlock(grid_, block, scorer.problem().freedoms.size());
    ScoredBlock scored;
    unsigned posed = 0;
    for (int i = 0; i < 4 && posed != kAllLanes; ++i) {
      scorer.ScoreBlock(values, 1u << ((first_branch + i) & 3), scored);
      for (const auto& obstacle : scored.obstacle)
        for (size_t l = 0; l < kLanes; ++l)
          if (obstacle[l] == Infeasibility::kNone) posed |= 1u << l;
    }
    return posed;
  }

  const Stations& stations_;
  std::span<const PassResult* const> passes_;
  const FixedTable& grid_;
  int threads_;
  std::stop_token stop_;
  std::vector<std::vector<std::vector<size_t>>> missing_;  ///< by pass and rotation: points
  std::vector<size_t> counts_;                             ///< of these, by rotation
};

}  // namespace

MissingPoints FewestMissing(const Stations& stations, std::span<const PassResult* const> passes,
                            const FixedTable& grid, int threads, std::stop_token stop) {
  return MissingSearch(stations, passes, grid, threads, std::move(stop)).Run();
}

}  // namespace millpose
