// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/fixed_rotation.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "machine/stiffness/compliance.hpp"
#include "planning/pass/fewest_missing.hpp"
#include "planning/pass/fixed_interference.hpp"

namespace millpose {
namespace {

constexpr size_t kNone = std::numeric_limits<size_t>::max();

/// One rotation and branch over a pass, by its value.
struct Ranked {
  double worst = kInfinity, sum = kInfinity;
  size_t rotation = 0;
  int branch = 0;
};

class Comparer {
 public:
  Comparer(const Stations& stations, const std::vector<PassResult>& passes,
           const FixedRotationOptions& options)
      : options_(options), stations_(stations), compared_(Compared(passes)) {
    size_t number = 0;
    for (const PassResult& pass : passes) {
      if (std::ranges::any_of(pass.points,
                              [](const auto& point) { return point.skip == Infeasibility::kNone; }))
        passes_.push_back({&pass, number, {}, {stations, pass, options}, {}});
      number += pass.points.size();
    }
    ParallelFor(passes_.size(), options.threads, options.stop, [&](size_t i) {
      passes_[i].table = MakeFixedTable(In(passes_[i]), compared_, {options.rotation_step, options.steps});
      passes_[i].free.assign(8 * passes_[i].table.rotations, 0);
    });
  }

  FixedComparison Compare() {
    FixedComparison comparison;
    for (const OfPass& pass : passes_) {
      const PlannedIn in = In(pass);
      for (size_t t = 0; t < pass.pass->points.size(); ++t) {
        const PlannedPoint& planned = pass.pass->points[t];
        if (compared_(planned))
          comparison.plan.push_back(FiguresAt(in.At(t).problem, planned, planned.q, planned.objective));
      }
    }
    if (passes_.empty()) {
      comparison.job_in_the_way = comparison.passes_in_the_way = "nothing is planned";
      return comparison;
    }
    CompareJob(comparison);
    ComparePasses(comparison);
    return comparison;
  }

 private:
  struct OfPass {
    const PassResult* pass;
    size_t first_point;
    FixedTable table;
    FixedInterference interference;
    std::vector<char> free;  ///< per rotation and branch: 0 not looked at, 1 free, 2 not
  };

  /// Made when it is needed: where axes move along passes all points together would be many.
  PlannedIn In(const OfPass& pass) const { return {stations_, *pass.pass}; }

  bool Better(const Ranked& a, const Ranked& b) const {
    const auto key = [&](const Ranked& r) {
      return options_.worst_first ? std::pair(r.worst, r.sum) : std::pair(r.sum, r.worst);
    };
    return key(a) < key(b);
  }

  /// The branches of a rotation that serve a pass but for interference, the best first.
  std::vector<Ranked> Branches(const OfPass& pass, size_t rotation) const {
    std::vector<Ranked> ranked;
    for (int branch = 0; branch < 8; ++branch) {
      const FixedTable::Entry& entry = pass.table.At(rotation, branch);
      if (entry.serves) ranked.push_back({entry.worst, entry.sum, rotation, branch});
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [&](const Ranked& a, const Ranked& b) { return Better(a, b); });
    return ranked;
  }

  /// Whether the pass is free of interference at a rotation on a branch; remembered.
  bool Free(OfPass& pass, const Ranked& ranked) {
    char& free = pass.free[8 * ranked.rotation + static_cast<size_t>(ranked.branch)];
    if (free == 0)
      free = pass.interference.IsFree(pass.table.Rotation(ranked.rotation), ranked.branch) ? 1 : 2;
    return free == 1;
  }

  /// The best free branch of a rotation over a pass.
  std::optional<Ranked> Served(OfPass& pass, size_t rotation) {
    for (const Ranked& ranked : Branches(pass, rotation))
      if (Free(pass, ranked)) return ranked;
    return std::nullopt;
  }

  void CompareJob(FixedComparison& comparison) {
    const size_t count = passes_.front().table.rotations;
    std::vector<Ranked> bounds;  // what a rotation gives at best, interference left aside
    for (size_t r = 0; r < count; ++r) {
      Ranked bound{0, 0, r, 0};
      for (const OfPass& pass : passes_) {
        const std::vector<Ranked> branches = Branches(pass, r);
        if (branches.empty()) bound.worst = bound.sum = kInfinity;
        if (!branches.empty()) bound.worst = std::max(bound.worst, branches.front().worst);
        if (!branches.empty()) bound.sum += branches.front().sum;
      }
      if (std::isfinite(bound.sum)) bounds.push_back(bound);
    }
    std::stable_sort(bounds.begin(), bounds.end(),
                     [&](const Ranked& a, const Ranked& b) { return Better(a, b); });
    Ranked best;
    std::vector<Ranked> chosen;
    size_t in_the_way = kNone;  // the pass that the last rotation failed at
    for (const Ranked& bound : bounds) {
      if (!chosen.empty() && !Better(bound, best)) break;
      std::vector<std::optional<Ranked>> served(passes_.size());
      bool all = in_the_way == kNone || Served(passes_[in_the_way], bound.rotation).has_value();
      if (!all) continue;
      ParallelFor(passes_.size(), options_.threads, options_.stop,
                  [&](size_t i) { served[i] = Served(passes_[i], bound.rotation); });
      Ranked whole{0, 0, bound.rotation, 0};
      for (size_t i = 0; i < served.size(); ++i) {
        all = all && served[i];
        if (!served[i]) in_the_way = i;
        if (!all) continue;
        whole.worst = std::max(whole.worst, served[i]->worst);
        whole.sum += served[i]->sum;
      }
      if (!all || (!chosen.empty() && !Better(whole, best))) continue;
      best = whole;
      chosen.clear();
      for (const auto& one : served) chosen.push_back(*one);
    }
    if (chosen.empty()) {
      comparison.job_in_the_way = bounds.empty() ? WhyNoneServes() : WhyNoneIsFree(bounds, in_the_way);
      return;
    }
    comparison.rotation = passes_.front().table.Rotation(best.rotation);
    for (size_t i = 0; i < chosen.size(); ++i) AddFigures(passes_[i], chosen[i], comparison.job);
  }

  /// The best free rotation and branch of a pass.
  std::optional<Ranked> BestOf(OfPass& pass) {
    std::vector<Ranked> all;
    for (size_t r = 0; r < pass.table.rotations; ++r)
      std::ranges::copy(Branches(pass, r), std::back_inserter(all));
    std::stable_sort(all.begin(), all.end(), [&](const Ranked& a, const Ranked& b) { return Better(a, b); });
    for (const Ranked& ranked : all)
      if (Free(pass, ranked)) return ranked;
    return std::nullopt;
  }

  /// Passes after one that has none do not matter. In batches, so that what is looked at, which is kept with
  /// the result, is the same for any number of threads.
  void ComparePasses(FixedComparison& comparison) {
    std::vector<std::optional<Ranked>> best(passes_.size());
    size_t done = 0;
    for (size_t batch = 1; done < best.size(); batch *= 2) {
      const size_t size = std::min(batch, best.size() - done);
      ParallelFor(size, options_.threads, options_.stop,
                  [&](size_t i) { best[done + i] = BestOf(passes_[done + i]); });
      for (const size_t end = done + size; done < end; ++done) {
        if (best[done]) continue;
        comparison.passes_in_the_way =
            fmt::format("no rotation serves pass {} on one branch within limits, steps and clearances",
                        passes_[done].pass->pass);
        return;
      }
    }
    for (size_t i = 0; i < best.size(); ++i) AddFigures(passes_[i], *best[i], comparison.passes);
  }

  /// The rotation that leaves fewest points without a pose, and these.
  std::string WhyNoneServes() const {
    std::vector<const PassResult*> results;
    for (const OfPass& pass : passes_) results.push_back(pass.pass);
    const FixedTable& grid = passes_.front().table;
    const MissingPoints missing = FewestMissing(stations_, results, grid, options_.threads, options_.stop);
    const double degrees = RadToDeg(grid.Rotation(missing.rotation));
    std::vector<size_t> numbers;
    for (size_t i = 0; i < passes_.size(); ++i)
      for (const size_t t : missing.of_pass[i])
        if (numbers.size() < 5) numbers.push_back(passes_[i].first_point + t);
    if (missing.count > 0)
      return fmt::format(
          "the rotation that serves most, {:.0f} deg, has no pose within the limits at {} points: {}{}",
          degrees, missing.count, fmt::join(numbers, ", "), missing.count > numbers.size() ? ", ..." : "");
    return fmt::format(
        "at {:.0f} deg every point has a pose within the limits, but no branch serves every pass "
        "within the joint steps",
        degrees);
  }

  std::string WhyNoneIsFree(const std::vector<Ranked>& bounds, size_t in_the_way) const {
    const OfPass& pass = passes_[in_the_way];
    std::vector<size_t> numbers;
    for (const size_t t : pass.interference.met())
      if (numbers.size() < 5) numbers.push_back(pass.first_point + t);
    return fmt::format(
        "{} rotations serve every point within the limits, none is free of interference; in pass "
        "{} it is met at points {}",
        bounds.size(), pass.pass->pass, fmt::join(numbers, ", "));
  }

  static PointFigures FiguresAt(const PoseProblem& problem, const PlannedPoint& planned, const Joints& q,
                                double objective) {
    const Eigen::Vector3d origin = problem.origin == StiffnessOrigin::kToolTip
                                       ? Eigen::Vector3d(problem.X_FT.translation())
                                       : Eigen::Vector3d::Zero();
    const Matrix6 C = Compliance(Jacobian(problem.arm, q, origin), problem.arm.stiffness) +
                      SeriesComplianceAt(problem.arm, q, origin, problem.compliances);
    const Eigen::Matrix3d R_BW = problem.X_WB.linear().transpose();
    const Eigen::Vector3d moved = C.topLeftCorner<3, 3>() * (R_BW * planned.point.engagement.force);
    return {objective, std::abs((R_BW * planned.point.normal).dot(moved)), moved.norm()};
  }

  void AddFigures(const OfPass& pass, const Ranked& ranked, std::vector<PointFigures>& figures) const {
    const PlannedIn in = In(pass);
    for (size_t t = 0; t < pass.pass->points.size(); ++t) {
      const PlannedPoint& planned = pass.pass->points[t];
      if (!compared_(planned)) continue;
      const PoseProblem& problem = in.At(t).problem;
      const Candidate candidate = PointScorer(problem, planned.point, pass.pass->rotation_reference)
                                      .ScoreOne({pass.table.Rotation(ranked.rotation)}, ranked.branch);
      figures.push_back(FiguresAt(problem, planned, candidate.q, candidate.objective));
    }
  }

  const FixedRotationOptions& options_;
  const Stations& stations_;
  PointFilter compared_;
  std::vector<OfPass> passes_;
};

}  // namespace

FixedComparison CompareWithFixed(const Stations& stations, const std::vector<PassResult>& passes,
                                 const FixedRotationOptions& options) {
  return Comparer(stations, passes, options).Compare();
}

}  // namespace millpose
