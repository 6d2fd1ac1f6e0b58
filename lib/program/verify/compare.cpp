// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/compare.hpp"

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/program_place.hpp"
#include "program/verify/compare_events.hpp"
#include "program/verify/confirmed_runs.hpp"
#include "program/verify/corner.hpp"
#include "program/verify/run_comparison.hpp"
#include "program/verify/stations.hpp"

namespace millpose {
namespace {

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

/// Motions first..last−1 of a program and, likewise, of its plan: joint motions between two cuts.
struct GapRange {
  size_t first, last, plan_first, plan_last;
};

void CompareGap(const Replayed& replayed, const Replayed& plan, const GapRange& range,
                const VerifyOptions& options, std::vector<Finding>& findings, std::vector<Proof>& proofs) {
  const auto [first, last, plan_first, plan_last] = range;
  const std::vector<Joints> way = Way(replayed, first, last), planned = Way(plan, plan_first, plan_last);
  if (way.empty() || planned.empty()) return;
  const auto [off, index] = FarthestFrom(planned, way);
  const auto [missed, unused] = FarthestFrom(way, planned);
  const size_t motion = std::min((first == 0 ? 0 : first - 1) + index, replayed.program.motions.size() - 1);
  if (off > options.gap_tolerance) {
    findings.push_back(At(replayed.program, motion, Cause::kWay,
                          fmt::format("the way between cuts leaves the planned one by {:.3f} deg of a joint",
                                      off * kDegPerRad)));
  } else if (missed > options.gap_tolerance) {
    findings.push_back(
        At(replayed.program, last > first ? last - 1 : motion, Cause::kWay,
           fmt::format("the way between cuts leaves out a planned one by {:.3f} deg of a joint",
                       missed * kDegPerRad)));
  }
  Proof proof{off <= options.gap_proven && missed <= options.gap_proven, 1};
  for (size_t i = plan_first; i < plan_last; ++i)
    proof.clearance_share = std::min(proof.clearance_share, plan.program.motions[i].clearance_share);
  for (size_t i = first; i < last; ++i) proofs[i] = proof;
}

/// Corners of ways that no stop ends: a controller rounds them, at most from half-way to half-way.
void CompareWayStops(const Replayed& replayed, size_t first, size_t last, const VerifyOptions& options,
                     std::vector<Finding>& findings, std::vector<Proof>& proofs) {
  const std::vector<Motion>& motions = replayed.program.motions;
  for (size_t i = first == 0 ? 0 : first - 1; i < last; ++i) {
    if (motions[i].exact || i + 1 >= motions.size()) continue;
    if (HasFeed(motions[i]) != HasFeed(motions[i + 1])) {
      findings.push_back(At(replayed.program, i, Cause::kStop,
                            "no stop between a way and a cut: a stop is planned here, but not programmed"));
      continue;
    }
    if (i == 0 || !replayed.replay.reached[i] || !replayed.replay.reached[i + 1]) continue;
    const auto& q = replayed.replay.targets;
    Joints rounding = RoundingOfWay(q[i - 1], q[i], q[i + 1]);
    const double xyz =
        rounding.head<3>().norm();  // LinuxCNC: the tolerance of G64 bounds them, and the time with them
    if (replayed.program.blend_overlaps && xyz > motions[i].angle_blend)
      rounding *= motions[i].angle_blend / xyz;
    const double off = rounding.cwiseAbs().maxCoeff();
    if (off > options.gap_tolerance)
      findings.push_back(
          At(replayed.program, i, Cause::kWay,
             fmt::format("the way between cuts is rounded here and may leave the planned one by "
                         "{:.3f} deg of a joint",
                         off * kDegPerRad)));
    if (off > options.gap_proven) proofs[i].proven = proofs[i + 1].proven = false;
  }
}

}  // namespace

std::vector<FeedRun> FeedRuns(const MotionProgram& program) {
  std::vector<FeedRun> runs;
  for (size_t i = 1; i < program.motions.size(); ++i) {
    if (!HasFeed(program.motions[i])) continue;
    if (runs.empty() || runs.back().last + 1 != i) runs.push_back({i, i});
    runs.back().last = i;
  }
  return runs;
}

std::vector<Proof> Compare(const Replayed& replayed, const Replayed& plan, const Cell& cell,
                           const VerifyOptions& options, const MotionQuery& look, const Execution& execution,
                           std::vector<Finding>& findings) {
  const size_t common = std::min(replayed.runs.size(), plan.runs.size());
  std::vector<Proof> proofs(replayed.program.motions.size());
  if (replayed.runs.size() != plan.runs.size()) {
    const size_t motion = replayed.runs.empty()           ? replayed.program.motions.size() - 1
                          : common < replayed.runs.size() ? replayed.runs[common].first
                                                          : replayed.runs.back().last;
    findings.push_back(At(replayed.program, motion, Cause::kPath,
                          fmt::format("{} cuts, planned are {}", replayed.runs.size(), plan.runs.size())));
  }
  const ArmBodies bodies(cell);
  std::vector<std::vector<Finding>> of_runs(common);
  ParallelFor(common, execution.Threads(), execution.stop, [&](size_t i) {
    const FeedRun& run = replayed.runs[i];
    const auto of_run = std::span(proofs).subspan(run.first, run.last + 1 - run.first);
    std::string key;
    if (options.confirmed) {
      key = ConfirmedRuns::KeyOf(replayed, run, plan, plan.runs[i], options);
      if (const std::vector<Proof> known = options.confirmed->Find(key); !known.empty()) {
        std::ranges::copy(known, of_run.begin());
        return;
      }
    }
    RunComparison comparison(replayed, run, plan, plan.runs[i], bodies, options, proofs);
    of_runs[i] = comparison.Compare();
    comparison.HandOn(look, of_runs[i]);
    if (options.confirmed && of_runs[i].empty()) options.confirmed->Add(key, {of_run.begin(), of_run.end()});
  });
  for (const auto& list : of_runs) findings.insert(findings.end(), list.begin(), list.end());

  for (size_t i = 0; i <= common; ++i) {
    const auto first = [&](const Replayed& r) { return i == 0 ? size_t{0} : r.runs[i - 1].last + 1; };
    const auto last = [&](const Replayed& r) {
      return i < r.runs.size() ? r.runs[i].first : r.program.motions.size();
    };
    CompareGap(replayed, plan, {first(replayed), last(replayed), first(plan), last(plan)}, options, findings,
               proofs);
    CompareWayStops(replayed, first(replayed), last(replayed), options, findings, proofs);
  }
  if (plan.program.frames_checked && !replayed.program.frames_checked)
    findings.push_back(At(replayed.program, 0, Cause::kOther,
                          "nothing stops the program before its first motion where the controller's frame is "
                          "another: the check of $ROBROOT is missing"));
  if (plan.program.notice != replayed.program.notice)
    findings.push_back(At(replayed.program, 0, Cause::kOther,
                          plan.program.notice.empty()
                              ? fmt::format("says \"{}\", which the plan does not", replayed.program.notice)
                              : fmt::format("the notice \"{}\" is missing", plan.program.notice)));
  CompareStations(replayed, plan, options, findings);
  CompareEvents(replayed, plan, false, cell, options, findings);
  return proofs;
}

}  // namespace millpose
