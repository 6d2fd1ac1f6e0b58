// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/free_smoothing.hpp"

#include <limits>

#include "base/units.hpp"
#include "machine/robot/angles.hpp"
#include "planning/pass/bend_law.hpp"
#include "planning/pass/lean_courses.hpp"
#include "planning/pose/score_along.hpp"

namespace millpose {
namespace {

constexpr int kSmoothingRounds = 32;           // of smoothing; then what still interferes goes back
constexpr double kWorthwhile = 0.97;           // of the mean square: go on
constexpr int kHalvings = 6;                   // of the way back to where a point was
constexpr double kMargin = 0.05 * kRadPerDeg;  // a range ends this much before what interferes
constexpr double kScan = 1 * kRadPerDeg;       // between looks on the way from there
constexpr size_t kFollow = 40;                 // points to either side that are smoothed again

class FreeSmoother {
 public:
  FreeSmoother(std::span<const PointScorer> scorers, std::span<const MillingPoint> points,
               SmoothOptions options, SegmentChecker& checker, std::span<PathNode> path)
      : scorers_(scorers),
        points_(points),
        options_(std::move(options)),
        checker_(checker),
        path_(path),
        law_(checker.checks(), scorers, options_.max_deviation),
        origin_(path.begin(), path.end()) {
    const Freedom& freedom = *scorers[0].problem().freedoms[options_.freedom];
    const double wide = freedom.Periodic() ? std::numeric_limits<double>::infinity() : 0;
    ranges_.assign(path.size(), {freedom.Lower() - wide, freedom.Upper() + wide});
    options_.before = MeasurePath(scorers, points, options_, path);
    for (const PathNode& node : origin_) looked_at_.push_back(node.q);
    doubtful_.assign(path.size(), false);
    for (size_t i = 0; i < path.size(); ++i) seen_free_.push_back({Was(i), Was(i)});
    ends_ = checker_.ToLeave(origin_, options_.closed);
    if (options_.keep_worst) BoundByWorst();
    if (options_.closed) closing_ = NearestEquivalent(path.back().q, path[0].q) - path[0].q;
  }

  void Run() {
    std::vector<PathNode> best = origin_;
    double least = options_.before.square;
    std::vector<FreedomRange> moving = ranges_;
    SegmentHits hits;
    bool whole = true;  // all points moved at once
    for (int round = 0; round < kSmoothingRounds; ++round) {
      const Smoothed smoothed = SmoothPath(scorers_, points_, moving, options_, path_);
      options_.repair = smoothed.repaired;
      options_.weight = 0;
      const SmoothReference now = MeasurePath(scorers_, points_, options_, path_);
      const bool better = now.square < kWorthwhile * least && Keeps(now);
      // What is hardly better than a free course need not be looked at.
      if (!better && least < options_.before.square) break;
      hits = Check();
      if (hits.any()) {
        Bound(hits);
        moving = Clamped(hits.Points());
        whole = false;
        continue;
      }
      if (!better) break;
      least = now.square;
      best.assign(path_.begin(), path_.end());
      // Free: once more, all points at once, between the bounds that were found. If these are as they were,
      // only on from there; a ring gains by looking for the weight again.
      if (whole && !options_.closed) options_.weight = smoothed.weight;
      whole = true;
      moving = ranges_;
    }
    if (least == options_.before.square) {
      for (size_t reach = 0; hits.any() && reach < 2 * path_.size(); reach = 2 * reach + 1) {
        GoBack(hits, reach);
      }
      const SmoothReference now = MeasurePath(scorers_, points_, options_, path_);
      if (!hits.any() && now.square < least && Keeps(now)) return;
    }
    std::copy(best.begin(), best.end(), path_.begin());
  }

 private:
  size_t Next(size_t i) const { return i + 1 == path_.size() ? 0 : i + 1; }

  /// Whether a path gives up no more than it may and deviates half-way no more than it may.
  bool Keeps(const SmoothReference& path) const {
    const std::vector<double> limits = DeviationLimits(options_);
    for (size_t i = 0; i < limits.size(); ++i) {
      if (path.deviation[i] > limits[i]) return false;
    }
    if (options_.keep_worst && path.worst > options_.before.worst) return false;
    return path.objective <= (1 + options_.loss) * options_.before.objective;
  }

  /// Ends the ranges where the objective would exceed the path's worst.
  void BoundByWorst() {
    constexpr double kLook = 2 * kRadPerDeg;
    for (size_t i = 0; i < path_.size(); ++i) {
      ranges_[i].lower = std::max(ranges_[i].lower, ReachWithinWorst(i, -kLook));
      ranges_[i].upper = std::min(ranges_[i].upper, ReachWithinWorst(i, kLook));
    }
  }

  /// How far point `i` comes before the objective exceeds the path's worst, in looks by `step`.
  double ReachWithinWorst(size_t i, double step) const {
    constexpr int kLooks = 15;
    double reach = Was(i);
    for (int first = 1; first <= kLooks; first += kLanes) {
      std::array<double, kLanes> x;
      for (int l = 0; l < kLanes; ++l) x[static_cast<size_t>(l)] = Was(i) + (first + l) * step;
      const std::array<Candidate, kLanes> found =
          ScoreAlong(scorers_[i], origin_[i].freedoms, options_.freedom, x, origin_[i].branch);
      for (int l = 0; l < kLanes && first + l <= kLooks; ++l) {
        const std::optional<PathNode> node =
            Stood(i, x[static_cast<size_t>(l)], found[static_cast<size_t>(l)]);
        if (!node || node->objective > options_.before.worst) return reach;
        reach = x[static_cast<size_t>(l)];
      }
    }
    return reach;
  }

  /// Interference, steps beyond the bound and a ring whose end leaves the limits.
  SegmentHits Check() {
    std::vector<bool> known(path_.size());
    for (size_t i = 0; i < path_.size(); ++i) known[i] = !doubtful_[i] && path_[i].q == looked_at_[i];
    SegmentHits hits = checker_.Check(path_, options_.closed, ends_, known);
    hits.pose[0] |= !EndsWithin(path_[0].q);
    for (size_t i = 0; i < path_.size(); ++i) {
      if (options_.closed || i + 1 < path_.size())
        hits.motion[i] |=
            !StepWithin(i, path_[i], path_[Next(i)]) || !BendsWithin(i, path_[i], path_[Next(i)]);
    }
    doubtful_ = hits.Points();
    for (size_t i = 0; i < path_.size(); ++i) looked_at_[i] = path_[i].q;
    return hits;
  }

  bool StepWithin(size_t i, const PathNode& from, const PathNode& to) const {
    const Joints step = (to.q - from.q).unaryExpr(&WrapToPi);
    if (!options_.max_lean.empty() && !LeansWithin(from.freedoms, to.freedoms, options_.max_lean[i]))
      return false;
    return (step.cwiseAbs().array() <= options_.max_step[i].array() + kRevolutionRounding).all();
  }

  /// Whether a motion bends no further than it may, or, where it did before, no further than it did.
  bool BendsWithin(size_t i, const PathNode& from, const PathNode& to) const {
    const double bend = law_.Bend(i, from.q, (to.q - from.q).unaryExpr(&WrapToPi));
    const auto most = [&](const PathNode& node) {
      return law_.Most(kSmoothedBend, i, node.freedoms, node.branch, node.q);
    };
    if (bend <= law_.bound() || bend <= most(from)) return true;
    const double was = options_.before.deviation[i];
    return bend <= was && was > most(origin_[i]);
  }

  /// A ring comes back to its first point with the turns that it made.
  bool EndsWithin(const Joints& first) const {
    return scorers_[0].problem().bounds.Hold(first + closing_, kRevolutionRounding);
  }

  /// Point `i` at a value of its freedom; empty where it is not admissible there.
  std::optional<PathNode> At(size_t i, double x) const {
    FreedomValues freedoms = origin_[i].freedoms;
    if (x == Was(i)) return origin_[i];
    freedoms[options_.freedom] = x;
    return Stood(i, x, scorers_[i].ScoreOne(freedoms, origin_[i].branch));
  }
  /// The same, `candidate` being what it is there.
  std::optional<PathNode> Stood(size_t i, double x, const Candidate& candidate) const {
    if (candidate.obstacle != Infeasibility::kNone) return std::nullopt;
    PathNode node = origin_[i];
    node.freedoms[options_.freedom] = x;
    node.q = NearestEquivalent(node.q, candidate.q);
    node.objective = candidate.objective;
    if (!scorers_[i].problem().bounds.Hold(node.q, kRevolutionRounding)) return std::nullopt;
    return node;
  }
  double Was(size_t i) const { return origin_[i].freedoms[options_.freedom]; }
  double Now(size_t i) const { return path_[i].freedoms[options_.freedom]; }

  bool PoseFree(PassCheckers& checkers, size_t i, double x) const {
    const std::optional<PathNode> node = At(i, x);
    if (!node || (i == 0 && !EndsWithin(node->q)) || !checker_.PoseFree(checkers, i, node->q)) return false;
    if (i == 0 && !checker_.Leaves(0, node->q, ends_.first)) return false;
    return i + 1 < path_.size() || checker_.Leaves(i, node->q, ends_.last);
  }
  bool MotionFree(PassCheckers& checkers, size_t i, double x, double x_next) const {
    const std::optional<PathNode> from = At(i, x), to = At(Next(i), x_next);
    return from && to && StepWithin(i, *from, *to) && BendsWithin(i, *from, *to) &&
           checker_.MotionFree(checkers, i, from->q, to->q);
  }

  /// The largest share of 0..1 that was found free, 1 not being; 0 is.
  template <typename Free>
  static double FreeShare(const Free& free) {
    double good = 0, bad = 1;
    for (int i = 0; i < kHalvings; ++i) {
      const double share = 0.5 * (good + bad);
      (free(share) ? good : bad) = share;
    }
    return good;
  }

  /// How far point `i` can go towards where it stands, in steps from where it was: beyond what interferes in
  /// between it may be free again, but it would have to pass through.
  double ReachOf(PassCheckers& checkers, size_t i, bool interferes) {
    const double x = Now(i);
    FreedomRange& seen = seen_free_[i];
    double& good = x > Was(i) ? seen.upper : seen.lower;
    if (interferes && std::abs(x - Was(i)) <= std::abs(good - Was(i))) good = Was(i);  // between two looks
    while (std::abs(x - Was(i)) > std::abs(good - Was(i))) {
      const double next = x > good ? std::min(good + kScan, x) : std::max(good - kScan, x);
      if (!PoseFree(checkers, i, next)) {
        good += (next - good) *
                FreeShare([&](double share) { return PoseFree(checkers, i, good + share * (next - good)); });
        return good;
      }
      good = next;
    }
    return x;
  }

  /// Ends the ranges of the points beside what interferes where they are not free.
  void Bound(const SegmentHits& hits) {
    const size_t count = path_.size();
    const std::vector<bool> beside = Widened(hits.Points(), kFollow, options_.closed);
    std::vector<double> reach(count);
    checker_.Each(count, [&](PassCheckers& checkers, size_t i) {
      reach[i] = beside[i] ? ReachOf(checkers, i, hits.pose[i]) : Now(i);
    });
    const auto whole = [&](size_t i) { return reach[i] == Now(i); };
    std::vector<double> share(count, 1);
    checker_.Each(count, [&](PassCheckers& checkers, size_t i) {
      const size_t next = Next(i);
      if (!hits.motion[i] || !whole(i) || !whole(next)) return;
      const auto at = [&](size_t k, double part) { return Was(k) + part * (reach[k] - Was(k)); };
      share[i] = FreeShare([&](double part) { return MotionFree(checkers, i, at(i, part), at(next, part)); });
    });
    for (size_t i = 0; i < count; ++i) {
      End(i, reach[i], share[i]);
      End(Next(i), reach[Next(i)], share[i]);
    }
  }

  /// Ends the range of point `i` at `share` of the way from where it was to `reach`, less the margin; not
  /// where it may stand as it does.
  void End(size_t i, double reach, double share) {
    if (share == 1 && reach == Now(i)) return;
    const double shift = share * (reach - Was(i)), kept = std::max(std::abs(shift) - kMargin, 0.0);
    if (Now(i) >= Was(i)) ranges_[i].upper = std::min(ranges_[i].upper, Was(i) + kept);
    if (Now(i) <= Was(i)) ranges_[i].lower = std::max(ranges_[i].lower, Was(i) - kept);
  }

  /// Brings all points into their ranges; the ranges of those that may move now: beside what was hit.
  std::vector<FreedomRange> Clamped(const std::vector<bool>& hit) {
    const std::vector<bool> beside = Widened(hit, kFollow, options_.closed);
    std::vector<FreedomRange> moving = ranges_;
    for (size_t i = 0; i < path_.size(); ++i) {
      const double x = Now(i), kept = std::clamp(x, ranges_[i].lower, ranges_[i].upper);
      if (x != kept) {
        std::optional<PathNode> node = At(i, kept);
        if (!node) {
          node = origin_[i];
          (x > kept ? ranges_[i].upper : ranges_[i].lower) = Was(i);
          moving[i] = ranges_[i];
        }
        path_[i] = *node;
      }
      if (!beside[i]) moving[i] = {kept, kept};
    }
    return moving;
  }

  /// What interferes goes back to where it was, with `reach` points to either side.
  void GoBack(SegmentHits& hits, size_t reach) {
    const std::vector<bool> back = Widened(hits.Points(), reach, options_.closed);
    for (size_t i = 0; i < path_.size(); ++i) {
      if (back[i]) path_[i] = origin_[i];
    }
    hits = Check();
  }

  std::span<const PointScorer> scorers_;
  std::span<const MillingPoint> points_;
  SmoothOptions options_;
  SegmentChecker& checker_;
  std::span<PathNode> path_;
  BendLaw law_;
  std::vector<PathNode> origin_;  ///< free
  EndShares ends_;
  std::vector<FreedomRange> ranges_;
  std::vector<FreedomRange> seen_free_;  ///< looked at in steps
  std::vector<Joints> looked_at_;        ///< where the points stood when last looked at
  std::vector<bool> doubtful_;           ///< and met something
  Joints closing_ = Joints::Zero();      ///< the turns of a ring, rad
};

}  // namespace

void SmoothFree(std::span<const PointScorer> scorers, std::span<const MillingPoint> points,
                SmoothOptions options, SegmentChecker& checker, std::span<PathNode> path) {
  if (path.size() < 3 || options.loss <= 0) return;
  FreeSmoother(scorers, points, std::move(options), checker, path).Run();
}

}  // namespace millpose
