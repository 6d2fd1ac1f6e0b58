// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/compare.hpp"

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "robot/kinematics.hpp"
#include "verify/follow.hpp"

namespace millpose {
namespace {

constexpr size_t kLookAhead = 64;  // planned points that a program may leave out in one step

/// One feed run of the program against its counterpart of the plan.
class RunComparison {
 public:
  RunComparison(const Replayed& replayed, const FeedRun& run, const Replayed& plan, const FeedRun& plan_run,
                const Cell& cell, const VerifyOptions& options)
      : replayed_(replayed),
        run_(run),
        plan_(plan),
        plan_run_(plan_run),
        cell_(cell),
        options_(options),
        X_PB_(cell.X_WP.inverse() * cell.X_WB) {}

  std::vector<Finding> Compare() {
    if (!ReachedAll()) return {};  // said already
    for (size_t i = plan_run_.first - 1; i <= plan_run_.last; ++i)
      path_.push_back(plan_.program.motions[i].X_PT);
    Sample();
    CompareForward();
    CompareBackward();
    CompareStops();
    return std::move(findings_);
  }

 private:
  const Motion& PlanMotion(size_t segment) const { return plan_.program.motions[plan_run_.first + segment]; }
  /// The real tool in the real workpiece's frame: what the plan states is compared there.
  Pose Tool(const Joints& q) const { return X_PB_ * ForwardFlange(cell_.arm, q) * cell_.X_FT; }

  bool ReachedAll() const {
    for (size_t i = run_.first - 1; i <= run_.last; ++i) {
      if (!replayed_.replay.reached[i]) return false;
    }
    return true;
  }

  void Sample() {
    Instant start;
    start.q = replayed_.replay.targets[run_.first - 1];
    start.X_BT = ForwardFlange(cell_.arm, start.q) * cell_.X_FT;
    start.motion = run_.first;
    instants_.push_back(start);
    for (size_t i = run_.first; i <= run_.last; ++i) {
      AppendInstants(replayed_.program, cell_, replayed_.replay, i, options_.step, instants_, findings_);
    }
    for (const Instant& instant : instants_) driven_.push_back(X_PB_ * instant.X_BT);
  }

  /// Every instant of the program lies on the plan's path, in order, and runs at the plan's feed.
  void CompareForward() {
    PathFollower follower(path_, kLookAhead, options_);
    std::optional<size_t> reported, slow;
    for (size_t i = 0; i < instants_.size(); ++i) {
      const Instant& instant = instants_[i];
      const PathDeviation deviation = follower.Follow(driven_[i]);
      if (!deviation.Within(options_) && reported != instant.motion) {
        reported = instant.motion;
        findings_.push_back(
            At(replayed_.program, instant.motion,
               fmt::format("{} leaves the plan: {}", Name(deviation.segment), deviation.Text())));
      }
      // Feed is a property of a motion; the middle of it tells which planned one it belongs to.
      if (i > 0 && instant.share >= 0.5 && slow != instant.motion) {
        slow = instant.motion;
        CompareFeed(instants_[i - 1], instant, follower.segment());
      }
    }
  }

  void CompareFeed(const Instant& before, const Instant& instant, size_t segment) {
    const Motion& motion = replayed_.program.motions[instant.motion];
    double feed = motion.feed;
    if (motion.type == MotionType::kJoint) {
      const double span = instant.share - (before.motion == instant.motion ? before.share : 0);
      feed = (instant.X_BT.translation() - before.X_BT.translation()).norm() / (span * motion.duration);
      if (feed * motion.duration < options_.position_tolerance) return;  // turns only
    }
    const double wanted = PlanMotion(segment).feed;
    if (feed > wanted * options_.feed_most || feed < wanted * options_.feed_least) {
      findings_.push_back(At(replayed_.program, instant.motion,
                             fmt::format("{} runs at {:.3f} mm/min, planned are {:.3f} mm/min", Name(segment),
                                         feed * 60, wanted * 60)));
    }
  }

  /// Every planned point is visited, in order.
  void CompareBackward() {
    PathFollower follower(driven_, driven_.size(), options_);
    for (size_t k = 0; k < path_.size(); ++k) {
      const PathDeviation deviation = follower.Follow(path_[k]);
      if (deviation.Within(options_)) continue;
      const Instant& nearest = instants_[std::min(deviation.segment + 1, instants_.size() - 1)];
      findings_.push_back(
          At(replayed_.program, nearest.motion,
             fmt::format("{} is not reached: {}", Name(k == 0 ? 0 : k - 1), deviation.Text())));
      return;
    }
  }

  /// No stop and no repeated place within the cut: both end the motion at once and mark the surface.
  void CompareStops() {
    for (size_t i = run_.first; i < run_.last; ++i) {
      const Motion& motion = replayed_.program.motions[i];
      if (motion.blend > options_.position_tolerance) {
        findings_.push_back(
            At(replayed_.program, i, fmt::format("corners are rounded by {:.3f} mm", motion.blend)));
      }
      const bool stands =
          (Tool(replayed_.replay.targets[i]).matrix() - Tool(replayed_.replay.targets[i - 1]).matrix())
              .cwiseAbs()
              .maxCoeff() < 1e-6;
      if (stands && i > run_.first) {
        findings_.push_back(At(replayed_.program, i, "the motion goes nowhere: the tool stops in the cut"));
      } else if (motion.exact && !PlannedStop(i)) {
        findings_.push_back(At(replayed_.program, i, "exact stop within the cut"));
      }
    }
  }

  bool PlannedStop(size_t i) const {
    const Pose tool = Tool(replayed_.replay.targets[i]);
    for (size_t k = 0; k + 1 < path_.size(); ++k) {
      const bool near =
          (path_[k + 1].translation() - tool.translation()).norm() <= options_.position_tolerance;
      if (near && PlanMotion(k).exact) return true;
    }
    return false;
  }

  std::string Name(size_t segment) const {
    const Motion& motion = PlanMotion(std::min(segment, plan_run_.last - plan_run_.first));
    if (motion.point < 0) return fmt::format("pass {}, retract", motion.pass);
    return fmt::format("pass {}, point {}", motion.pass, motion.point);
  }

  const Replayed& replayed_;
  const FeedRun run_;
  const Replayed& plan_;
  const FeedRun plan_run_;
  const Cell& cell_;
  const VerifyOptions& options_;
  Pose X_PB_;
  std::vector<Pose> path_;  // the plan's, segment k ends at path_[k + 1]
  std::vector<Instant> instants_;
  std::vector<Pose> driven_;  // the instants' tools in P
  std::vector<Finding> findings_;
};

/// Distance (rad, largest joint) of q from the straight joint motion a → b, and where on it.
double JointDistance(const Joints& a, const Joints& b, const Joints& q, double from, double& share) {
  const Joints along = b - a;
  const double squared = along.squaredNorm();
  share = std::clamp(squared > 0 ? (q - a).dot(along) / squared : 1.0, from, 1.0);
  return (q - a - share * along).cwiseAbs().maxCoeff();
}

/// Joint positions `path` visited in order along the way-points `way`: the largest distance, and at which
/// index.
std::pair<double, size_t> FarthestFrom(const std::vector<Joints>& way, const std::vector<Joints>& path) {
  std::pair<double, size_t> farthest{0, 0};
  size_t segment = 0;
  double from = 0;
  for (size_t i = 0; i < path.size(); ++i) {
    double best = (path[i] - way.front()).cwiseAbs().maxCoeff();
    if (way.size() > 1) best = std::numeric_limits<double>::infinity();
    size_t best_segment = segment;
    double best_share = from;
    for (size_t k = segment; k + 1 < way.size(); ++k) {
      double share = 0;
      const double distance = JointDistance(way[k], way[k + 1], path[i], k == segment ? from : 0.0, share);
      if (distance >= best) continue;
      best = distance;
      best_segment = k;
      best_share = share;
    }
    segment = best_segment;
    from = best_share;
    if (best > farthest.first) farthest = {best, i};
  }
  return farthest;
}

/// Targets of the motions first..last−1 with the place before them.
std::vector<Joints> Way(const Replayed& replayed, size_t first, size_t last) {
  std::vector<Joints> way;
  for (size_t i = first == 0 ? 0 : first - 1; i < last; ++i) way.push_back(replayed.replay.targets[i]);
  return way;
}

void CompareGap(const Replayed& replayed, size_t first, size_t last, const Replayed& plan, size_t plan_first,
                size_t plan_last, const VerifyOptions& options, std::vector<Finding>& findings,
                std::vector<size_t>& unproven) {
  const std::vector<Joints> way = Way(replayed, first, last), planned = Way(plan, plan_first, plan_last);
  if (way.empty() || planned.empty()) return;
  const auto [off, index] = FarthestFrom(planned, way);
  const auto [missed, unused] = FarthestFrom(way, planned);
  const size_t motion = std::min((first == 0 ? 0 : first - 1) + index, replayed.program.motions.size() - 1);
  if (off > options.gap_tolerance) {
    findings.push_back(At(replayed.program, motion,
                          fmt::format("the way between cuts leaves the planned one by {:.3f} deg of a joint",
                                      off * kDegPerRad)));
  } else if (missed > options.gap_tolerance) {
    findings.push_back(
        At(replayed.program, last > first ? last - 1 : motion,
           fmt::format("the way between cuts leaves out a planned one by {:.3f} deg of a joint",
                       missed * kDegPerRad)));
  } else if (off > options.gap_proven || missed > options.gap_proven) {
    for (size_t i = std::max<size_t>(first, 1); i < last; ++i) unproven.push_back(i);
  }
}

/// The spindle's changes: after how many feed motions' runs, and within one or not.
struct SpindleChange {
  bool on;
  double speed;
  size_t runs;
  bool within;
  const ProgramEvent* event;
};

std::vector<SpindleChange> SpindleChanges(const Replayed& replayed) {
  std::vector<SpindleChange> changes;
  for (const ProgramEvent& event : replayed.program.events) {
    const bool on = event.kind == ProgramEvent::Kind::kSpindleOn;
    if (!on && event.kind != ProgramEvent::Kind::kSpindleOff) continue;
    SpindleChange change{on, on ? event.value : 0, 0, false, &event};
    for (const FeedRun& run : replayed.runs) {
      if (run.first < event.before_motion) change.runs += 1;
      if (run.first < event.before_motion && event.before_motion <= run.last) change.within = true;
    }
    changes.push_back(change);
  }
  return changes;
}

void CompareSpindle(const Replayed& replayed, const Replayed& plan, const VerifyOptions& options,
                    std::vector<Finding>& findings) {
  const std::vector<SpindleChange> given = SpindleChanges(replayed), wanted = SpindleChanges(plan);
  for (size_t i = 0; i < std::max(given.size(), wanted.size()); ++i) {
    if (i < given.size() && i < wanted.size()) {
      const SpindleChange &a = given[i], &b = wanted[i];
      const bool same = a.on == b.on && a.runs == b.runs && a.within == b.within &&
                        std::abs(a.speed - b.speed) <= options.spindle_tolerance;
      if (same) continue;
    }
    const auto name = [](const SpindleChange& change) {
      return change.on ? fmt::format("on at {:.3f} 1/min after cut {}", change.speed * 60, change.runs)
                       : fmt::format("off after cut {}", change.runs);
    };
    // A change that is missing shows where the cut before it ends.
    const size_t runs = i < wanted.size() ? std::min(wanted[i].runs, replayed.runs.size()) : 0;
    const size_t motion = runs == 0 ? 0 : replayed.runs[runs - 1].last;
    Finding finding = At(replayed.program, motion, "");
    if (i < given.size()) finding.line = given[i].event->line;
    finding.message = fmt::format("the spindle is switched {}, planned is {}",
                                  i < given.size() ? name(given[i]) : "no more",
                                  i < wanted.size() ? name(wanted[i]) : "no change");
    findings.push_back(finding);
    return;
  }
}

}  // namespace

bool HasFeed(const Motion& motion) { return motion.type == MotionType::kLinear || motion.duration > 0; }

std::vector<FeedRun> FeedRuns(const MotionProgram& program) {
  std::vector<FeedRun> runs;
  for (size_t i = 1; i < program.motions.size(); ++i) {
    if (!HasFeed(program.motions[i])) continue;
    if (runs.empty() || runs.back().last + 1 != i) runs.push_back({i, i});
    runs.back().last = i;
  }
  return runs;
}

void Compare(const Replayed& replayed, const Replayed& plan, const Cell& cell, const VerifyOptions& options,
             int threads, std::stop_token stop, std::vector<Finding>& findings,
             std::vector<size_t>& unproven) {
  const size_t common = std::min(replayed.runs.size(), plan.runs.size());
  if (replayed.runs.size() != plan.runs.size()) {
    const size_t motion = replayed.runs.empty()           ? replayed.program.motions.size() - 1
                          : common < replayed.runs.size() ? replayed.runs[common].first
                                                          : replayed.runs.back().last;
    findings.push_back(At(replayed.program, motion,
                          fmt::format("{} cuts, planned are {}", replayed.runs.size(), plan.runs.size())));
  }
  std::vector<std::vector<Finding>> of_runs(common);
  ParallelFor(common, threads, stop, [&](size_t i) {
    of_runs[i] = RunComparison(replayed, replayed.runs[i], plan, plan.runs[i], cell, options).Compare();
  });
  for (const auto& list : of_runs) findings.insert(findings.end(), list.begin(), list.end());

  for (size_t i = 0; i <= common; ++i) {
    const auto first = [&](const Replayed& r) { return i == 0 ? size_t{0} : r.runs[i - 1].last + 1; };
    const auto last = [&](const Replayed& r) {
      return i < r.runs.size() ? r.runs[i].first : r.program.motions.size();
    };
    CompareGap(replayed, first(replayed), last(replayed), plan, first(plan), last(plan), options, findings,
               unproven);
  }
  CompareSpindle(replayed, plan, options, findings);
}

}  // namespace millpose
