// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/promising_reversals.hpp"

#include "base/parallel.hpp"
#include "job/job_engagement.hpp"
#include "planning/pose/lean_problem.hpp"
#include "planning/pose/search.hpp"
#include "store/cached_stage.hpp"
#include "toolpath/make_toolpath.hpp"
#include "toolpath/pass_variants.hpp"

namespace millpose {
namespace {

constexpr int kSettings = 48;  // of the rotation, for the first look at what a way promises
constexpr size_t kEvery = 4;   // one in so many points is asked what the other way promises

PointOptimum OwnOptimum(const PointScorer& scorer) {
  if (!HasLean(scorer.problem())) return RefineTable(scorer, CandidateTable::OfSize(scorer, kSettings));
  return DescendTable(scorer, CandidateTable::OfStep(scorer, 2 * kPi / kSettings));
}

/// Of those points of a pass that `asked` names.
Promise PromiseOf(const PoseProblem& problem, const Pass& pass, const std::vector<char>& asked) {
  Promise promise;
  double way = 0, sum = 0;
  const std::vector<MillingPoint>& points = pass.points;
  for (size_t t = 0; t < points.size(); ++t) {
    if (points[t].gouge > 0 || asked[t] == 0) continue;
    const PointOptimum best = OwnOptimum(PointScorer(problem, points[t], pass.rotation_reference));
    if (!best.found) continue;
    const double own = WayAt(t, points.size(), [&](size_t i) { return points[i].position; });
    way += own;
    sum += own * best.objective;
    if (points[t].kind != PointKind::kCut) continue;
    promise.worst = std::max(promise.worst, best.objective);
    promise.sum += best.objective;
  }
  if (way > 0) promise.mean = sum / way;
  return promise;
}

/// Both ends of the cut and every fourth point from either: the same ones whichever way the pass is run.
std::vector<char> EverySome(const Pass& pass) {
  std::vector<size_t> cut;
  for (size_t t = 0; t < pass.points.size(); ++t)
    if (pass.points[t].kind == PointKind::kCut) cut.push_back(t);
  std::vector<char> sample(pass.points.size(), 0);
  for (size_t i = 0; i < cut.size(); ++i)
    if (std::min(i, cut.size() - 1 - i) % kEvery == 0) sample[cut[i]] = 1;
  return sample;
}

class WayFinder {
 public:
  WayFinder(const PreparedJob& prepared, bool worst_first, const Execution& execution)
      : prepared_(prepared), worst_first_(worst_first), execution_(execution) {
    ways_.turned = prepared.made.toolpath;
    ways_.promising.resize(Count(), 0);
    ways_.laid.resize(Count());
    for (Pass& pass : ways_.turned.passes)
      if (pass.reversible) pass = RunFromEnd(pass);
  }

  /// What is not asked about stays turned until the end: the force at a pass depends on what those before it
  /// have milled.
  PromisingReversals Find(const std::vector<char>& wanted) {
    std::vector<std::vector<char>> asked(Count());
    for (size_t i = 0; i < Count(); ++i) {
      const Pass& pass = ways_.turned.passes[i];
      const bool may = pass.reversible && wanted[i] != 0 && !prepared_.external[i].Moves();
      asked[i] = may ? EverySome(pass) : std::vector<char>(pass.points.size());
    }
    SetEngagementAt(asked);
    Each([&](size_t i) { ways_.promising[i] = IsPromising(i, asked[i]) ? 1 : 0; });
    for (size_t i = 0; i < Count(); ++i) std::ranges::fill(asked[i], ways_.promising[i]);
    SetEngagementAt(asked);
    Each([&](size_t i) {
      if (ways_.promising[i] != 0)
        ways_.laid[i] = PromiseOf(Problem(i), prepared_.toolpath.passes[i], asked[i]);
      else
        ways_.turned.passes[i] = {};
    });
    return std::move(ways_);
  }

 private:
  size_t Count() const { return prepared_.toolpath.passes.size(); }
  const Station& StationOf(size_t pass) const { return prepared_.stations.At(prepared_.external[pass].from); }
  const PoseProblem& Problem(size_t pass) const { return StationOf(pass).problem; }

  bool IsPromising(size_t i, const std::vector<char>& asked) const {
    if (std::ranges::count(asked, 1) == 0) return false;
    const Pass& laid = prepared_.toolpath.passes[i];
    Pass turned = ways_.turned.passes[i];
    Transform(StationOf(i).world.cell().X_WP, turned);
    turned.rotation_reference = laid.rotation_reference;
    const Promise now = PromiseOf(Problem(i), laid, {asked.rbegin(), asked.rend()});
    const Promise other = PromiseOf(Problem(i), turned, asked);
    constexpr double kLess = 1 - kGainOfTurning;
    return (worst_first_ && other.worst < now.worst * kLess) || other.sum < now.sum * kLess;
  }
  void SetEngagementAt(const std::vector<std::vector<char>>& points) {
    SetEngagementOf(points, prepared_.laying.inputs, prepared_.laying.mesh, execution_, ways_.turned);
  }
  void Each(const std::function<void(size_t)>& work) const {
    ParallelFor(Count(), execution_.Threads(), execution_.stop, work);
  }

  const PreparedJob& prepared_;
  bool worst_first_;
  const Execution& execution_;
  PromisingReversals ways_;
};

}  // namespace

PromisingReversals FindPromisingReversals(const PreparedJob& prepared, const std::vector<char>& wanted,
                                          bool worst_first, const CheckpointStore& checkpoints,
                                          const Execution& execution) {
  const Cell& cell = prepared.cell;
  const std::string key =
      StageKey(prepared.laying.key, prepared.made.toolpath, prepared.toolpath, prepared.external,
               prepared.problem, cell.X_WP, cell.external_axes, wanted, worst_first);
  return Cached<PromisingReversals>(checkpoints, "other-ways", key,
                                    [&] { return WayFinder(prepared, worst_first, execution).Find(wanted); });
}

bool IsBetterThanAny(const PassValue& plan, const Promise& promise, bool worst_first) {
  const PassValue best{0, 1, promise.worst, promise.mean};
  return plan.skipped == 0 && plan.pieces == 1 && IsBetter(plan, best, worst_first, kGainOfTurning);
}

}  // namespace millpose
