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
#include "planning/result/station.hpp"

namespace millpose {
namespace {

constexpr size_t kNone = std::numeric_limits<size_t>::max();

/// One rotation and branch over a pass, by its value.
struct Ranked {
  double worst = kInfinity, sum = kInfinity;
  size_t rotation = 0;
  int branch = 0;
};

/// Figures of one point in one pose.
struct PointFigures {
  double objective = 0, normal = 0, length = 0;  ///< as in ComparedFigures
};

OverPoints Over(const std::vector<PointFigures>& points, double PointFigures::*member) {
  OverPoints over;
  std::vector<double> values;
  values.reserve(points.size());
  for (const PointFigures& point : points) {
    values.push_back(point.*member);
    over.sum += values.back();
  }
  if (values.empty()) return over;
  over.worst = std::ranges::max(values);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  over.median =
      values.size() % 2 == 1 ? *middle : 0.5 * (*std::max_element(values.begin(), middle) + *middle);
  return over;
}

ComparedFigures FiguresOver(const std::vector<PointFigures>& points) {
  return {points.size(), Over(points, &PointFigures::objective), Over(points, &PointFigures::normal),
          Over(points, &PointFigures::length)};
}

class Comparer {
 public:
  Comparer(const Stations& stations, const std::vector<PassResult>& passes,
           const FixedRotationOptions& options, std::vector<FixedPass>& of_passes)
      : options_(options),
        stations_(stations),
        compared_(Compared(passes)),
        face_(OfFace(passes, options.finished_from)) {
    size_t number = 0;
    for (size_t i = 0; i < passes.size(); ++i) {
      const PassResult& pass = passes[i];
      if (std::ranges::any_of(pass.points,
                              [](const auto& point) { return point.skip == Infeasibility::kNone; }))
        passes_.push_back({pass, number, of_passes[i], {of_passes[i].stations, pass, options}});
      number += pass.points.size();
    }
    RankBy(stations);
    for (OfPass& pass : passes_) pass.of.known.free.resize(pass.Table().entries.size(), 0);
  }

  FixedComparison Compare() {
    FixedComparison comparison;
    std::vector<PointFigures> planned_points;
    for (const OfPass& pass : passes_) {
      const PlannedIn in = In(pass);
      std::vector<Joints> q;
      for (const PlannedPoint& planned : pass.pass.points) q.push_back(planned.q);
      comparison.plan_gears.Add(GearsWith(pass, in, q));
      for (size_t t = 0; t < pass.pass.points.size(); ++t) {
        const PlannedPoint& planned = pass.pass.points[t];
        if (compared_(planned))
          planned_points.push_back(FiguresAt(in.At(t).problem, planned, planned.q, planned.objective));
      }
    }
    comparison.plan = FiguresOver(planned_points);
    if (passes_.empty()) {
      comparison.job_in_the_way = comparison.passes_in_the_way = "nothing is planned";
      return comparison;
    }
    CompareJob(comparison);
    ComparePasses(comparison);
    if (comparison.plan.length.worst > 0) CompareByLength(comparison);
    return comparison;
  }

 private:
  struct OfPass {
    const PassResult& pass;
    size_t first_point;
    FixedPass& of;
    FixedInterference interference;
    size_t ranked_by = 0;  ///< which table

    const FixedTable& Table() const { return of.known.tables[ranked_by]; }
  };

  /// Ranks rotations from now on by the objective of `ranking`, which that of the tables is; what is free
  /// does not change.
  void RankBy(const Stations& ranking, size_t table = 0) {
    ParallelFor(passes_.size(), options_.threads, options_.stop, [&](size_t i) {
      std::vector<FixedTable>& tables = passes_[i].of.known.tables;
      passes_[i].ranked_by = table;
      if (tables.size() == table)
        tables.push_back(
            MakeFixedTable({ranking, passes_[i].pass}, compared_, {options_.rotation_step, options_.steps}));
    });
  }

  /// Made when it is needed: where axes move along passes all points together would be many.
  PlannedIn In(const OfPass& pass) const { return {stations_, pass.pass}; }

  /// How rotations are ranked, and up to which worst value they count.
  struct Criterion {
    bool worst_first;
    double limit = kInfinity;

    bool Better(const Ranked& a, const Ranked& b) const {
      const auto key = [&](const Ranked& r) {
        return worst_first ? std::pair(r.worst, r.sum) : std::pair(r.sum, r.worst);
      };
      return key(a) < key(b);
    }
    void Sort(std::vector<Ranked>& ranked) const {
      std::stable_sort(ranked.begin(), ranked.end(),
                       [this](const Ranked& a, const Ranked& b) { return Better(a, b); });
    }
  };

  /// The branches of a rotation that serve a pass but for interference, the best first.
  static std::vector<Ranked> Branches(const OfPass& pass, size_t rotation, const Criterion& by) {
    std::vector<Ranked> ranked;
    for (int branch = 0; branch < 8; ++branch) {
      const FixedTable::Entry& entry = pass.Table().At(rotation, branch);
      if (entry.serves && entry.worst <= by.limit)
        ranked.push_back({entry.worst, entry.sum, rotation, branch});
    }
    by.Sort(ranked);
    return ranked;
  }

  /// Whether the pass is free of interference at a rotation on a branch; remembered.
  static bool Free(OfPass& pass, const Ranked& ranked) {
    char& free = pass.of.known.free[8 * ranked.rotation + static_cast<size_t>(ranked.branch)];
    if (free == 0)
      free = pass.interference.IsFree(pass.Table().Rotation(ranked.rotation), ranked.branch) ? 1 : 2;
    return free == 1;
  }

  /// The best free branch of a rotation over a pass.
  static std::optional<Ranked> Served(OfPass& pass, size_t rotation, const Criterion& by) {
    for (const Ranked& ranked : Branches(pass, rotation, by))
      if (Free(pass, ranked)) return ranked;
    return std::nullopt;
  }

  /// What every rotation gives the job at best, interference left aside; the best first.
  std::vector<Ranked> JobBounds(const Criterion& by) const {
    std::vector<Ranked> bounds;
    for (size_t r = 0; r < passes_.front().Table().rotations; ++r) {
      Ranked bound{0, 0, r, 0};
      for (const OfPass& pass : passes_) {
        const std::vector<Ranked> branches = Branches(pass, r, by);
        if (branches.empty()) bound.worst = bound.sum = kInfinity;
        if (!branches.empty()) bound.worst = std::max(bound.worst, branches.front().worst);
        if (!branches.empty()) bound.sum += branches.front().sum;
      }
      if (std::isfinite(bound.sum)) bounds.push_back(bound);
    }
    by.Sort(bounds);
    return bounds;
  }

  /// The best free branch of every pass at a rotation; empty where one has none, which is `in_the_way` then.
  /// Passes are asked from the one on that was in the way last, for what meets something at one rotation
  /// mostly does so beside it at the next. They are asked in batches, each twice as large as the one before:
  /// so what is looked at, which is kept, is the same for any number of threads.
  std::vector<Ranked> ServedAtAll(size_t rotation, const Criterion& by, size_t& in_the_way) {
    std::vector<size_t> order(passes_.size());
    std::iota(order.begin(), order.end(), 0);
    const size_t from = in_the_way == kNone ? passes_.size() / 2 : in_the_way;
    std::ranges::stable_sort(order, {}, [&](size_t i) { return i < from ? from - i : i - from; });
    std::vector<std::optional<Ranked>> served(passes_.size());
    for (size_t batch = 1, done = 0; done < order.size(); batch *= 2) {
      const size_t end = std::min(done + batch, order.size());
      ParallelFor(end - done, options_.threads, options_.stop, [&](size_t i) {
        served[order[done + i]] = Served(passes_[order[done + i]], rotation, by);
      });
      for (; done < end; ++done) {
        if (served[order[done]]) continue;
        in_the_way = order[done];
        return {};
      }
    }
    std::vector<Ranked> all;
    for (const auto& one : served) all.push_back(*one);
    return all;
  }

  /// The best rotation of the whole job.
  struct BestOfJob {
    Ranked whole;
    std::vector<Ranked> passes;  ///< empty where none serves all
  };
  BestOfJob BestForJob(const std::vector<Ranked>& bounds, const Criterion& by, size_t& in_the_way) {
    BestOfJob best;
    for (const Ranked& bound : bounds) {
      if (!best.passes.empty() && !by.Better(bound, best.whole)) break;
      std::vector<Ranked> served = ServedAtAll(bound.rotation, by, in_the_way);
      if (served.empty()) continue;
      Ranked whole{0, 0, bound.rotation, 0};
      for (const Ranked& one : served) {
        whole.worst = std::max(whole.worst, one.worst);
        whole.sum += one.sum;
      }
      if (best.passes.empty() || by.Better(whole, best.whole)) best = {whole, std::move(served)};
    }
    return best;
  }

  FixedChoice ChoiceOf(const BestOfJob& best) const {
    FixedChoice choice = FiguresOf(best.passes);
    choice.rotations = {passes_.front().Table().Rotation(best.whole.rotation)};
    return choice;
  }

  void CompareJob(FixedComparison& comparison) {
    const Criterion by{options_.worst_first};
    const std::vector<Ranked> bounds = JobBounds(by);
    size_t in_the_way = kNone;  // the pass that the last rotation failed at
    const BestOfJob best = BestForJob(bounds, by, in_the_way);
    if (best.passes.empty()) {
      comparison.job_in_the_way = bounds.empty() ? WhyNoneServes() : WhyNoneIsFree(bounds, in_the_way);
      return;
    }
    comparison.job = ChoiceOf(best);
    const Criterion worst{true};
    const double least =
        options_.worst_first ? best.whole.worst : BestForJob(JobBounds(worst), worst, in_the_way).whole.worst;
    const Criterion near{false, (1 + kNearBest) * least};
    comparison.job_by_sum = ChoiceOf(BestForJob(JobBounds(near), near, in_the_way));
  }

  /// Where a rotation serves the job, or one each pass, those that are best in |cF|.
  void CompareByLength(FixedComparison& comparison) {
    PoseProblem problem = stations_.problem();
    problem.objective = MakeObjective("process_force", {});
    RankBy(Stations(stations_.world(), std::move(problem)), 1);
    const Criterion by{options_.worst_first};
    size_t in_the_way = kNone;
    if (comparison.job.Exists())
      comparison.job_by_length = ChoiceOf(BestForJob(JobBounds(by), by, in_the_way));
    if (!comparison.passes.Exists()) return;
    std::vector<Ranked> best(passes_.size());
    ParallelFor(passes_.size(), options_.threads, options_.stop,
                [&](size_t i) { best[i] = *BestOf(passes_[i], by); });
    comparison.passes_by_length = FiguresOf(best);
  }

  /// The best free rotation and branch of a pass.
  static std::optional<Ranked> BestOf(OfPass& pass, const Criterion& by) {
    std::vector<Ranked> all;
    for (size_t r = 0; r < pass.Table().rotations; ++r)
      std::ranges::copy(Branches(pass, r, by), std::back_inserter(all));
    by.Sort(all);
    for (const Ranked& ranked : all)
      if (Free(pass, ranked)) return ranked;
    return std::nullopt;
  }

  /// Passes after one that has none do not matter. In batches, so that what is looked at, which is kept with
  /// the result, is the same for any number of threads.
  void ComparePasses(FixedComparison& comparison) {
    std::vector<std::optional<Ranked>> best(passes_.size()), by_sum(passes_.size());
    size_t done = 0;
    for (size_t batch = 1; done < best.size(); batch *= 2) {
      const size_t size = std::min(batch, best.size() - done);
      ParallelFor(size, options_.threads, options_.stop, [&](size_t i) {
        OfPass& pass = passes_[done + i];
        best[done + i] = BestOf(pass, {options_.worst_first});
        if (!best[done + i]) return;
        const double least = options_.worst_first ? best[done + i]->worst : BestOf(pass, {true})->worst;
        by_sum[done + i] = BestOf(pass, {false, (1 + kNearBest) * least});
      });
      for (const size_t end = done + size; done < end; ++done) {
        if (best[done]) continue;
        comparison.passes_in_the_way =
            fmt::format("no rotation serves pass {} on one branch within limits, steps and clearances",
                        passes_[done].pass.pass);
        return;
      }
    }
    const auto chosen = [&](const std::vector<std::optional<Ranked>>& of) {
      std::vector<Ranked> all;
      for (const auto& one : of) all.push_back(*one);
      return FiguresOf(all);
    };
    comparison.passes = chosen(best);
    comparison.passes_by_sum = chosen(by_sum);
  }

  /// The rotation that leaves fewest points without a pose, and these.
  std::string WhyNoneServes() const {
    std::vector<const PassResult*> results;
    for (const OfPass& pass : passes_) results.push_back(&pass.pass);
    const FixedTable& grid = passes_.front().Table();
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

  /// Where the best rotations meet something, asked anew: what is known of a pass does not tell.
  std::string WhyNoneIsFree(const std::vector<Ranked>& bounds, size_t in_the_way) const {
    constexpr size_t kMostTold = 5, kMostAsked = 32;
    const OfPass& pass = passes_[in_the_way];
    FixedInterference interference(pass.of.stations, pass.pass, options_);
    for (size_t i = 0; i < std::min(bounds.size(), kMostAsked); ++i)
      for (const Ranked& ranked : Branches(pass, bounds[i].rotation, {options_.worst_first}))
        if (interference.met().size() < kMostTold)
          interference.IsFree(pass.Table().Rotation(ranked.rotation), ranked.branch);
    std::vector<size_t> numbers;
    for (const size_t t : interference.met()) numbers.push_back(pass.first_point + t);
    return fmt::format(
        "{} rotations serve every point within the limits, none is free of interference; in pass {} {}",
        bounds.size(), pass.pass.pass,
        numbers.empty() ? "the ends cannot be left"
                        : fmt::format("it is met at points {}", fmt::join(numbers, ", ")));
  }

  static PointFigures FiguresAt(const PoseProblem& problem, const PlannedPoint& planned, const Joints& q,
                                double objective) {
    const Eigen::Vector3d origin = problem.origin == StiffnessOrigin::kToolTip
                                       ? Eigen::Vector3d(problem.X_FT.translation())
                                       : Eigen::Vector3d::Zero();
    const LinkPoses frames = LinkFrames(problem.arm, q);
    const Matrix6 C = Compliance(Jacobian(problem.arm, frames, origin), problem.arm.stiffness) +
                      SeriesComplianceAt(frames, origin, problem.compliances);
    const Eigen::Matrix3d R_BW = problem.X_WB.linear().transpose();
    const Eigen::Vector3d moved = C.topLeftCorner<3, 3>() * (R_BW * planned.point.engagement.force);
    return {objective, std::abs((R_BW * planned.point.normal).dot(moved)), moved.norm()};
  }

  /// What a rotation and branch for each pass give.
  FixedChoice FiguresOf(const std::vector<Ranked>& chosen) const {
    std::vector<std::vector<PointFigures>> of_pass(passes_.size());
    std::vector<GearTally> gears(passes_.size());
    ParallelFor(passes_.size(), options_.threads, options_.stop,
                [&](size_t i) { gears[i] = AddFigures(passes_[i], chosen[i], of_pass[i]); });
    FixedChoice all;
    std::vector<PointFigures> points;
    for (size_t i = 0; i < passes_.size(); ++i) {
      points.insert(points.end(), of_pass[i].begin(), of_pass[i].end());
      all.rotations.push_back(passes_[i].Table().Rotation(chosen[i].rotation));
      all.gears.Add(gears[i]);
    }
    all.figures = FiguresOver(points);
    return all;
  }

  /// Adds the figures of a pass; returns what its gears do.
  GearTally AddFigures(const OfPass& pass, const Ranked& ranked, std::vector<PointFigures>& points) const {
    const PlannedIn in = In(pass);
    std::vector<Joints> q(pass.pass.points.size());
    for (size_t t = 0; t < q.size(); ++t) {
      const PlannedPoint& planned = pass.pass.points[t];
      if (planned.skip != Infeasibility::kNone) continue;
      const PoseProblem& problem = in.At(t).problem;
      const Candidate candidate = PointScorer(problem, planned.point, pass.pass.rotation_reference)
                                      .ScoreOne({pass.Table().Rotation(ranked.rotation)}, ranked.branch);
      q[t] = candidate.q;
      if (compared_(planned)) points.push_back(FiguresAt(problem, planned, candidate.q, candidate.objective));
    }
    return GearsWith(pass, in, q);
  }

  /// What the gears do with these joint angles (each up to full revolutions) at the points of a pass.
  GearTally GearsWith(const OfPass& pass, const PlannedIn& in, const std::vector<Joints>& q) const {
    const PoseProblem& problem = stations_.problem();
    const Mechanism mechanism(stations_.world().cell().external_axes);
    GearCourse course;
    FollowPass(
        options_.gears, {problem.arm, problem.X_FT, mechanism}, pass.pass,
        [&](size_t t) {
          return PosedPoint{&pass.pass.points[t].point, q[t], in.At(t).problem.X_WB,
                            ExternalAt(pass.pass, t)};
        },
        face_, course);
    return TallyOf(course, options_.gears, mechanism.axes());
  }

  const FixedRotationOptions& options_;
  const Stations& stations_;
  PointFilter compared_;
  FaceFilter face_;
  std::vector<OfPass> passes_;
};

}  // namespace

FixedComparison CompareWithFixed(const Stations& stations, const std::vector<PassResult>& passes,
                                 const FixedRotationOptions& options, std::vector<FixedPass>& of_passes) {
  return Comparer(stations, passes, options, of_passes).Compare();
}

}  // namespace millpose
