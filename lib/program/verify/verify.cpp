// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/verify.hpp"

#include <cassert>
#include <map>
#include <set>
#include <span>

#include "base/parallel.hpp"
#include "base/units.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/controller_axes.hpp"
#include "program/stated_speeds.hpp"
#include "program/verify/compare.hpp"
#include "program/verify/compare_events.hpp"
#include "program/verify/coordinated_path.hpp"
#include "program/verify/corner.hpp"
#include "program/verify/corner_bound.hpp"
#include "program/verify/stations.hpp"

namespace millpose {
namespace {

constexpr double kLimitSlack = 1e-7;  // rad: rounding of six decimals of a degree
constexpr size_t kMotionsPerTask = 64;
constexpr int kRoundingPlaces = 9;       // of the largest rounding of a way
constexpr double kInterferenceStep = 5;  // mm between joint motions that stand for a straight one

/// What holds for every motion whatever the plan: limits, speeds, singularity.
class MotionCheck {
 public:
  /// `jumps`: report jumps of the speed too.
  MotionCheck(const Replayed& replayed, const Cell& cell, const VerifyOptions& options, bool jumps)
      : replayed_(replayed), cell_(cell), options_(options), jumps_(jumps) {}

  void Check(size_t i, std::vector<Finding>& findings) const {
    if (!CheckTarget(i, findings)) return;
    std::vector<Instant> instants;
    AppendInstants(replayed_.program, cell_, replayed_.replay, i, options_.step, instants, findings);
    CheckWay(i, instants, findings);
  }
  /// The same of a motion whose instants are known.
  void Check(size_t i, std::span<const Instant> instants, std::vector<Finding>& findings) const {
    if (CheckTarget(i, findings)) CheckWay(i, instants, findings);
  }

 private:
  /// What is to be said of the end of motion `i`; returns whether the way there is to be looked at.
  bool CheckTarget(size_t i, std::vector<Finding>& findings) const {
    if (!replayed_.replay.reached[i] || !CheckExternal(replayed_, i, cell_, findings)) return false;
    CheckTurn(i, findings);
    if (CheckLimits(i, replayed_.replay.targets[i], findings)) return false;
    return i > 0 && HasFeed(replayed_.program.motions[i]);
  }

  void CheckWay(size_t i, std::span<const Instant> instants, std::vector<Finding>& findings) const {
    const Motion& motion = replayed_.program.motions[i];
    const double seconds = Seconds(i);
    if (seconds > 0 && CheckExternalSpeed(replayed_, i, seconds, findings)) return;
    Joints before = replayed_.replay.targets[i - 1];
    double share = 0;
    for (const Instant& instant : instants) {
      if (CheckLimits(i, instant.q, findings)) return;
      const double span = seconds * (instant.share - share);
      if (span > 0 && CheckSpeed(i, (instant.q - before).cwiseAbs() / span, findings)) return;
      if (motion.type == MotionType::kLinear && CheckWrist(i, instant.q, findings)) return;
      before = instant.q;
      share = instant.share;
    }
    if (jumps_) CheckJump(i, instants, findings);
  }

  /// Whether the speeds of tip and joints go on at the corner between motion i and the next.
  void CheckJump(size_t i, std::span<const Instant> instants, std::vector<Finding>& findings) const {
    const std::vector<Motion>& motions = replayed_.program.motions;
    if (motions[i].exact || i + 1 >= motions.size() || !HasFeed(motions[i + 1])) return;
    if (!replayed_.replay.reached[i + 1] || Seconds(i) <= 0 || Seconds(i + 1) <= 0) return;
    std::vector<Instant> next;
    std::vector<Finding> said;
    AppendInstants(replayed_.program, cell_, replayed_.replay, i + 1, options_.step, next, said);
    if (next.empty() || instants.empty()) return;
    const Joints& corner = replayed_.replay.targets[i];
    const bool single = instants.size() == 1;
    const Joints& last = single ? replayed_.replay.targets[i - 1] : instants[instants.size() - 2].q;
    const double span = 1 - (single ? 0 : instants[instants.size() - 2].share);
    const Joints jump =
        (next[0].q - corner) / (next[0].share * Seconds(i + 1)) - (corner - last) / (span * Seconds(i));
    for (int j = 0; j < 6; ++j) {
      if (std::abs(jump[j]) <= cell_.arm.acceleration[j] * options_.jump_time) continue;
      findings.push_back(At(replayed_.program, i, Cause::kCorner,
                            fmt::format("A{} would have to change its speed by {:.2f} deg/s at a corner that "
                                        "is passed without a stop",
                                        j + 1, std::abs(jump[j]) * kDegPerRad)));
      return;
    }
    if (const std::string why = ExternalJump(replayed_, i, Seconds(i), Seconds(i + 1), options_.jump_time);
        !why.empty()) {
      findings.push_back(At(replayed_.program, i, Cause::kCorner, why));
      return;
    }
    const double feed = Feed(i), after = Feed(i + 1);
    if (std::max(feed, after) <= options_.feed_jump * std::min(feed, after)) return;
    findings.push_back(
        At(replayed_.program, i + 1, Cause::kCorner,
           fmt::format("the feed jumps from {:.1f} to {:.1f} mm/min without a stop", feed * 60, after * 60)));
  }

  /// A turn bit says on which side of 0 a joint stands: nothing, where its own arithmetic decides that.
  void CheckTurn(size_t i, std::vector<Finding>& findings) const {
    const Motion& motion = replayed_.program.motions[i];
    if (motion.q || !motion.turn || motion.type != MotionType::kJoint) return;
    const Joints angles = replayed_.program.axes.FromArm(replayed_.replay.targets[i]);
    for (int j = 0; j < 6; ++j) {
      if (std::abs(std::remainder(angles[j], 2 * kPi)) >= kUncertainTurn) continue;
      findings.push_back(At(replayed_.program, i, Cause::kReach,
                            fmt::format("A{} is at {:.5f} deg, where a turn bit does not say whether it goes "
                                        "there directly or by a full revolution; joint angles expected",
                                        j + 1, angles[j] * kDegPerRad)));
      return;
    }
  }

  /// mm that the tip goes on the part in motion `i`.
  double Length(size_t i) const {
    const auto tip = [&](size_t k) {
      return Eigen::Vector3d(
          (ForwardFlange(cell_.arm, replayed_.replay.targets[k]) * cell_.X_FT).translation());
    };
    if (!CoordinatedMotions(replayed_.program, i)) return (tip(i) - tip(i - 1)).norm();
    const auto on_part = [&](size_t k) {
      return Eigen::Vector3d(BaseInPart(cell_, replayed_.program.motions[k].external) * tip(k));
    };
    return (on_part(i) - on_part(i - 1)).norm();
  }

  /// mm/s along a motion that takes Seconds().
  double Feed(size_t i) const { return Length(i) / Seconds(i); }

  /// 0 where nothing tells: the motion only turns, or has no feed.
  double Seconds(size_t i) const {
    const Motion& motion = replayed_.program.motions[i];
    if (motion.duration > 0 || motion.type == MotionType::kJoint) return motion.duration;
    const double length = Length(i);
    return motion.feed > 0 && length > 1e-3 ? length / motion.feed : 0;
  }

  bool CheckLimits(size_t i, const Joints& q, std::vector<Finding>& findings) const {
    for (int j = 0; j < 6; ++j) {
      if (q[j] >= options_.lower[j] - kLimitSlack && q[j] <= options_.upper[j] + kLimitSlack) continue;
      findings.push_back(
          At(replayed_.program, i, Cause::kReach,
             fmt::format("A{} at {:.3f} deg leaves its limits {:.3f} to {:.3f} deg", j + 1, q[j] * kDegPerRad,
                         options_.lower[j] * kDegPerRad, options_.upper[j] * kDegPerRad)));
      return true;
    }
    const CoupledLimit* beyond = FirstBeyond(options_.coupled, q, kLimitSlack);
    if (beyond == nullptr) return false;
    findings.push_back(At(replayed_.program, i, Cause::kReach, CoupledText(*beyond, q)));
    return true;
  }

  bool CheckSpeed(size_t i, const Joints& speed, std::vector<Finding>& findings) const {
    for (int j = 0; j < 6; ++j) {
      if (speed[j] <= cell_.arm.speed[j] * kSpeedSlack) continue;
      findings.push_back(At(replayed_.program, i, Cause::kJointSpeed,
                            fmt::format("A{} would turn at {:.2f} deg/s, it can do {:.2f} deg/s", j + 1,
                                        speed[j] * kDegPerRad, cell_.arm.speed[j] * kDegPerRad)));
      return true;
    }
    return false;
  }

  bool CheckWrist(size_t i, const Joints& q, std::vector<Finding>& findings) const {
    if (DistanceToSingularity(cell_.arm, q).wrist >= options_.wrist_least) return false;
    findings.push_back(
        At(replayed_.program, i, Cause::kReach,
           fmt::format("A5 at {:.3f} deg: the wrist is singular on a straight motion", q[4] * kDegPerRad)));
    return true;
  }

  const Replayed& replayed_;
  const Cell& cell_;
  const VerifyOptions& options_;
  const bool jumps_;
};

/// A joint motion as fast as the axes allow that goes on into the next one without a stop.
bool IsRounded(const Replayed& replayed, size_t i) {
  const std::vector<Motion>& motions = replayed.program.motions;
  return i + 1 < motions.size() && !motions[i].exact && !HasFeed(motions[i]) &&
         replayed.replay.reached[i + 1];
}

/// What motion `i` comes too near to on its whole way, the external axes standing, with the clearances of
/// `checker`.
std::optional<Interference> InterferenceOf(const Replayed& replayed, size_t i, const Cell& cell,
                                           Checker& checker, const VerifyOptions& options) {
  const Motion& motion = replayed.program.motions[i];
  const Phase phase = HasFeed(motion) ? Phase::kCutting : Phase::kFree;
  const auto found_along = [&](const std::vector<Joints>& way) {
    const auto found = checker.BlockedAlong(way, phase, options.swept_resolution);
    return found ? std::optional(checker.Measure(*found)) : std::nullopt;
  };
  std::optional<Interference> hit;
  if (i == 0) {
    hit = checker.At(replayed.replay.targets[0], phase);
  } else {
    std::vector<Instant> instants;
    std::vector<Finding> said;
    if (motion.type == MotionType::kLinear) {
      AppendInstants(replayed.program, cell, replayed.replay, i, kInterferenceStep, instants, said);
    } else {
      instants.push_back({replayed.replay.targets[i], {}, i, 1});
    }
    std::vector<Joints> way{replayed.replay.targets[i - 1]};
    for (const Instant& instant : instants) way.push_back(instant.q);
    hit = found_along(way);
    if (!hit && IsRounded(replayed, i)) {
      const auto& q = replayed.replay.targets;
      hit = found_along(LargestRounding(q[i - 1], q[i], q[i + 1], kRoundingPlaces));
    }
  }
  return hit;
}

/// What motion `i` comes too near to on its whole way, external axes moving along, with so much of the
/// clearances.
std::optional<Interference> InterferenceAlong(const Replayed& replayed, size_t i, const World& world,
                                              const Cell& commanded, double share,
                                              const VerifyOptions& options) {
  const MotionProgram& program = replayed.program;
  std::vector<Instant> instants;
  std::vector<Finding> said;
  if (program.motions[i].type == MotionType::kLinear)
    AppendInstants(program, commanded, replayed.replay, i, kInterferenceStep, instants, said);
  else
    instants.push_back({replayed.replay.targets[i], {}, i, 1});
  CoordinatedPath way{
      program.motions[i - 1].external, program.motions[i].external, {{0, replayed.replay.targets[i - 1]}}};
  for (const Instant& instant : instants) way.joints.emplace_back(instant.share, instant.q);
  return FindOnCoordinatedMotion(world, way, {share, options.clearance_reserve, options.swept_resolution});
}

/// Checkers of one world by where the external axes stand and the share of the clearances.
class Checkers {
 public:
  Checkers(const World& world, const VerifyOptions& options) : world_(world), options_(options) {}

  Checker& At(const ExternalPosition& external, double share) {
    const auto found = checkers_.find({external, share});
    if (found != checkers_.end()) return found->second;
    const World there = external.empty() ? world_ : world_.At(external);
    return checkers_.try_emplace({external, share}, there, share, options_.clearance_reserve).first->second;
  }

 private:
  const World& world_;
  const VerifyOptions& options_;
  std::map<std::pair<ExternalPosition, double>, Checker> checkers_;
};

/// Checks motion `i` for interference, with so much of the clearances; `commanded`: the cell that its
/// controller computes with.
void CheckInterference(const Replayed& replayed, size_t i, const World& world, const Cell& commanded,
                       Checkers& checkers, double share, const VerifyOptions& options,
                       std::vector<Finding>& findings) {
  const Motion& motion = replayed.program.motions[i];
  if (!replayed.replay.reached[i] || motion.call >= 0) return;
  std::optional<Interference> hit;
  if (CoordinatedMotions(replayed.program, i))
    hit = InterferenceAlong(replayed, i, world, commanded, share, options);
  else if (MovesExternal(replayed.program, i))
    hit = InterferenceOfMove(replayed, i, world, options.swept_resolution);
  else
    hit = InterferenceOf(replayed, i, commanded, checkers.At(motion.external, share), options);
  if (!hit) return;
  findings.push_back(
      At(replayed.program, i, Cause::kInterference,
         fmt::format("{} comes within {:.2f} mm of {} at ({:.1f}, {:.1f}, {:.1f}) mm", hit->first,
                     hit->distance, hit->second, hit->place().x(), hit->place().y(), hit->place().z())));
}

/// Which motions have findings, by their lines. They and what starts from them are not checked for
/// interference: their places are not where the program is meant to go, and may be anywhere.
std::vector<bool> WithFindings(const Replayed& replayed, const std::vector<Finding>& findings) {
  std::set<std::pair<std::string, int>> lines;
  for (const Finding& finding : findings) lines.insert({finding.file, finding.line});
  std::vector<bool> faulty;
  for (size_t i = 0; i < replayed.program.motions.size(); ++i) {
    const Finding here = At(replayed.program, i, Cause::kOther, "");
    faulty.push_back(lines.contains({here.file, here.line}));
  }
  return faulty;
}

/// Runs `work` over `count` motions in blocks and appends what it found in order.
void ForMotions(size_t count, const Execution& execution, std::vector<Finding>& findings,
                const std::function<void(size_t first, size_t last, std::vector<Finding>&)>& work) {
  const size_t tasks = (count + kMotionsPerTask - 1) / kMotionsPerTask;
  std::vector<std::vector<Finding>> found(tasks);
  ParallelFor(tasks, execution.Threads(), execution.stop, [&](size_t task) {
    work(task * kMotionsPerTask, std::min(count, (task + 1) * kMotionsPerTask), found[task]);
  });
  for (const auto& list : found) findings.insert(findings.end(), list.begin(), list.end());
}

/// By file and line, each once; of each cause the list is cut at the options' length and says how many were
/// left out.
std::vector<Finding> Ordered(std::vector<Finding> findings, const VerifyOptions& options) {
  std::stable_sort(findings.begin(), findings.end(), [](const Finding& a, const Finding& b) {
    return std::tie(a.file, a.line, a.message) < std::tie(b.file, b.line, b.message);
  });
  const auto same = [](const Finding& a, const Finding& b) {
    return a.file == b.file && a.line == b.line && a.message == b.message;
  };
  findings.erase(std::unique(findings.begin(), findings.end(), same), findings.end());
  std::vector<Finding> listed;
  std::map<Cause, std::vector<Finding>> more;
  std::map<Cause, size_t> kept;
  for (Finding& finding : findings) {
    const Cause cause = finding.cause;
    if (++kept[cause] <= options.most_findings)
      listed.push_back(std::move(finding));
    else
      more[cause].push_back(std::move(finding));
  }
  for (const auto& [cause, rest] : more) {
    listed.push_back({rest.back().file, rest.back().line, fmt::format("and {} more findings", rest.size()),
                      cause, rest.size()});
  }
  return listed;
}

}  // namespace

std::vector<Finding> Verify(const MotionProgram& program, const World& world, const MotionProgram* plan,
                            const VerifyOptions& given, const Execution& execution) {
  assert(IsWellFormed(program));
  const Cell& cell = world.cell();
  VerifyOptions options = given;
  std::vector<Finding> findings;
  if (program.motions.empty())
    return {{program.files.empty() ? "" : program.files[0], 0, "the program moves nothing", Cause::kPath}};
  const Replayed replayed{program, ReplayTargets(program, cell, findings), FeedRuns(program)};
  // By what nobody knows of its path the tool may come nearer too.
  const double unknown = CheckCornerBounds(replayed, cell, options, findings);
  options.clearance_reserve = std::max(0.0, options.clearance_reserve - unknown);

  // A program that states its feeds is held to them; for corners its control slows down.
  const MotionCheck check(replayed, cell, options, plan == nullptr && !StatedFeedsOf(program));
  std::vector<Proof> proofs(program.motions.size(), Proof{false, 1});
  if (plan != nullptr) {
    const Replayed planned{*plan, ReplayTargets(*plan, cell, findings), FeedRuns(*plan)};
    const MotionQuery look = [&](size_t i, std::span<const Instant> instants, std::vector<Finding>& found) {
      check.Check(i, instants, found);
    };
    proofs = Compare(replayed, planned, cell, options, look, execution, findings);
    if (options.written) {
      std::vector<Finding> said;  // of what was confirmed when it was written
      const Replayed written{*options.written, ReplayTargets(*options.written, cell, said),
                             FeedRuns(*options.written)};
      CompareEvents(replayed, written, true, cell, options, findings);
    }
  }
  ForMotions(program.motions.size(), execution, findings,
             [&](size_t first, size_t last, std::vector<Finding>& found) {
               for (size_t i = first; i < last; ++i)
                 if (!proofs[i].sampled) check.Check(i, found);
             });
  const World& bodies = options.as_it_is ? *options.as_it_is : world;
  const std::vector<bool> faulty = WithFindings(replayed, findings);
  std::vector<size_t> unproven;
  for (size_t i = 0; i < proofs.size(); ++i) {
    const bool needed = options.interference || !proofs[i].proven;
    if (needed && !faulty[i] && (i == 0 || !faulty[i - 1])) unproven.push_back(i);
  }
  ForMotions(unproven.size(), execution, findings,
             [&](size_t first, size_t last, std::vector<Finding>& found) {
               Checkers checkers(bodies, options);
               for (size_t k = first; k < last; ++k)
                 CheckInterference(replayed, unproven[k], bodies, cell, checkers,
                                   proofs[unproven[k]].clearance_share, options, found);
             });
  return Ordered(std::move(findings), options);
}

}  // namespace millpose
