// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/compare.hpp"

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "program/program_place.hpp"
#include "robot/kinematics.hpp"
#include "verify/corner.hpp"
#include "verify/run_comparison.hpp"
#include "verify/stations.hpp"

namespace millpose {
namespace {

constexpr double kSameDwell = 0.5e-3;  // s

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
    Finding finding = At(replayed.program, motion, Cause::kSwitching, "");
    if (i < given.size()) finding.line = given[i].event->line;
    finding.message = fmt::format("the spindle is switched {}, planned is {}",
                                  i < given.size() ? name(given[i]) : "no more",
                                  i < wanted.size() ? name(wanted[i]) : "no change");
    findings.push_back(finding);
    return;
  }
}

/// X_PT where the motion before an event ends.
Pose ToolBefore(const Replayed& replayed, const Cell& cell, const ProgramEvent& event) {
  const size_t before = event.before_motion > 0 ? event.before_motion - 1 : 0;
  const Pose X_BT = ForwardFlange(cell.arm, replayed.replay.targets[before]) * cell.X_FT;
  return BaseInPart(cell, replayed.program.motions[before].external) * X_BT;
}

/// Outputs are switched where the tool is.
struct Switching {
  PathOutput output;
  Pose X_PT;
  const ProgramEvent* event;
};

std::vector<Switching> SwitchingsOf(const Replayed& replayed, const Cell& cell) {
  std::vector<Switching> list;
  for (const ProgramEvent& event : replayed.program.events) {
    if (event.kind != ProgramEvent::Kind::kOutput) continue;
    list.push_back({event.output, ToolBefore(replayed, cell, event), &event});
  }
  return list;
}

void CompareOutputs(const Replayed& replayed, const Replayed& plan, const Cell& cell,
                    const VerifyOptions& options, std::vector<Finding>& findings) {
  const std::vector<Switching> given = SwitchingsOf(replayed, cell), wanted = SwitchingsOf(plan, cell);
  const auto name = [](const PathOutput& output) {
    return fmt::format("output {} {}", output.number, output.on ? "on" : "off");
  };
  for (size_t i = 0; i < std::max(given.size(), wanted.size()); ++i) {
    if (i < given.size() && i < wanted.size()) {
      const Switching &a = given[i], &b = wanted[i];
      const bool same = a.output.number == b.output.number && a.output.on == b.output.on &&
                        std::abs(a.output.delay - b.output.delay) < 0.5e-3 &&
                        (a.X_PT.translation() - b.X_PT.translation()).norm() <= options.position_tolerance;
      if (same) continue;
    }
    // One that is missing shows where the next one is, or at the end.
    const ProgramEvent* event = i < given.size() ? given[i].event : nullptr;
    Finding finding = At(replayed.program,
                         event ? std::min(event->before_motion, replayed.program.motions.size() - 1)
                               : replayed.program.motions.size() - 1,
                         Cause::kSwitching, "");
    if (event) finding.line = event->line;
    finding.message =
        fmt::format("{} is switched here, planned is {}", event ? name(given[i].output) : "no output",
                    i < wanted.size() ? name(wanted[i].output) + " at its place" : "none");
    findings.push_back(finding);
    return;
  }
}

/// Dwells within cuts, where the tool is; elsewhere they may be any.
struct Dwell {
  double seconds;
  Pose X_PT;
  const ProgramEvent* event;
};

std::vector<Dwell> DwellsOf(const Replayed& replayed, const Cell& cell) {
  std::vector<Dwell> list;
  for (const ProgramEvent& event : replayed.program.events)
    if (event.kind == ProgramEvent::Kind::kDwell &&
        PlaceOf(replayed.program, event.before_motion) == ProgramPlace::kStop)
      list.push_back({event.value, ToolBefore(replayed, cell, event), &event});
  return list;
}

void CompareDwells(const Replayed& replayed, const Replayed& plan, const Cell& cell,
                   const VerifyOptions& options, std::vector<Finding>& findings) {
  const std::vector<Dwell> given = DwellsOf(replayed, cell), wanted = DwellsOf(plan, cell);
  for (size_t i = 0; i < std::max(given.size(), wanted.size()); ++i) {
    if (i < given.size() && i < wanted.size() &&
        std::abs(given[i].seconds - wanted[i].seconds) < kSameDwell &&
        (given[i].X_PT.translation() - wanted[i].X_PT.translation()).norm() <= options.position_tolerance)
      continue;
    const auto name = [&](const std::vector<Dwell>& list) {
      return i < list.size() ? fmt::format("{} s", list[i].seconds) : std::string("none");
    };
    Finding finding =
        At(replayed.program,
           i < given.size() ? given[i].event->before_motion : replayed.program.motions.size() - 1,
           Cause::kStop, "");
    if (i < given.size()) finding.line = given[i].event->line;
    finding.message = fmt::format("a dwell in the cut here: {}, planned: {}{}", name(given), name(wanted),
                                  i < wanted.size() ? " at its place" : "");
    findings.push_back(finding);
    return;
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
                           const VerifyOptions& options, const MotionLook& look, const Execution& execution,
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
    RunComparison comparison(replayed, replayed.runs[i], plan, plan.runs[i], bodies, options, proofs);
    of_runs[i] = comparison.Compare();
    comparison.HandOn(look, of_runs[i]);
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
  CompareSpindle(replayed, plan, options, findings);
  CompareOutputs(replayed, plan, cell, options, findings);
  CompareDwells(replayed, plan, cell, options, findings);
  return proofs;
}

}  // namespace millpose
