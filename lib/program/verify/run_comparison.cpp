// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/verify/run_comparison.hpp"

#include "base/units.hpp"
#include "machine/motion/line.hpp"
#include "machine/robot/kinematics.hpp"
#include "program/verify/stations.hpp"

namespace millpose {
namespace {

constexpr size_t kLookAhead = 64;    // planned points that a program may leave out in one step
constexpr double kSpareLength = 10;  // mm beyond the planned length of a cut that are sampled in any case

bool CoordinatedWithin(const MotionProgram& program, const FeedRun& run) {
  for (size_t i = run.first; i <= run.last; ++i)
    if (CoordinatedMotions(program, i)) return true;
  return false;
}

}  // namespace

RunComparison::RunComparison(const Replayed& replayed, const FeedRun& run, const Replayed& plan,
                             const FeedRun& plan_run, const ArmBodies& bodies, const VerifyOptions& options,
                             std::vector<Proof>& proofs)
    : replayed_(replayed),
      run_(run),
      plan_(plan),
      plan_run_(plan_run),
      cell_(bodies.cell()),
      bodies_(bodies),
      options_(options),
      proofs_(proofs),
      plan_rides_(CoordinatedWithin(plan.program, plan_run)),
      rides_(plan_rides_ || CoordinatedWithin(replayed.program, run)),
      X_PB_(BaseInPart(cell_, replayed.program.motions[run.first].external)) {}

std::vector<Finding> RunComparison::Compare() {
  if (!ReachedAll()) return {};  // said already
  for (size_t i = plan_run_.first - 1; i <= plan_run_.last; ++i)
    path_.push_back(plan_.program.motions[i].X_PT);
  if (EntersByRoundedAngles()) path_.front() = Tool(run_.first - 1);
  if (!LengthsFit()) return std::move(findings_);
  Sample();
  CompareForward();
  CompareBackward();
  CompareStops();
  return std::move(findings_);
}

void RunComparison::HandOn(const MotionQuery& look, std::vector<Finding>& findings) const {
  for (size_t begin = 1, end = 1; begin < instants_.size(); begin = end) {  // behind the start of the run
    const size_t motion = instants_[begin].motion;
    while (end < instants_.size() && instants_[end].motion == motion) ++end;
    look(motion, std::span(instants_).subspan(begin, end - begin), findings);
    proofs_[motion].sampled = true;
  }
}

Pose RunComparison::BaseAt(size_t i, double share) const {
  return rides_ ? BaseInPart(cell_, ExternalOf(replayed_.program, i, share)) : X_PB_;
}

Pose RunComparison::ToolAt(size_t i, double share, const Joints& q) const {
  return BaseAt(i, share) * ForwardFlange(cell_.arm, q) * cell_.X_FT;
}

bool RunComparison::ReachedAll() const {
  for (size_t i = run_.first - 1; i <= run_.last; ++i) {
    if (!replayed_.replay.reached[i]) return false;
  }
  return true;
}

/// Whether the way to the run ends at the planned joint angles as three decimals of a degree have them (LS
/// states no more): the tip then stands up to some hundredths of a millimetre off, in the air, and goes
/// straight from there.
bool RunComparison::EntersByRoundedAngles() const {
  constexpr double kHalfOfTheLast = 0.0005 * kRadPerDeg * (1 + 1e-6);
  const Motion& entry = replayed_.program.motions[run_.first - 1];
  if (entry.type != MotionType::kJoint || !entry.q) return false;
  const Joints &planned = plan_.replay.targets[plan_run_.first - 1], off = *entry.q - planned;
  // Couplings of axes (J3 against the level) add the rounding of two.
  if (off.cwiseAbs().maxCoeff() > 2 * kHalfOfTheLast) return false;
  const Pose tool = ToolAt(run_.first, 0, planned);  // with a tool other than the plan's it is elsewhere
  return (tool.translation() - path_.front().translation()).norm() <= 0.1 * options_.position_tolerance;
}

/// Motions far longer than any that was planned are reported before they are sampled.
bool RunComparison::LengthsFit() {
  double planned = 0, longest = 0;
  for (size_t k = 1; k < path_.size(); ++k) {
    const double length = (path_[k].translation() - path_[k - 1].translation()).norm();
    planned += length;
    longest = std::max(longest, length);
  }
  double driven = 0;
  for (size_t i = run_.first; i <= run_.last; ++i) {
    const double length = (Tool(i).translation() - Tool(i - 1).translation()).norm();
    driven += length;
    const bool fits = length <= 2 * planned + kSpareLength && driven <= 3 * planned + kSpareLength;
    if (fits) continue;
    findings_.push_back(
        At(replayed_.program, i, Cause::kPath,
           fmt::format("leaves the plan: a motion of {:.1f} mm, {:.1f} mm from the start of the "
                       "cut on; the longest planned has {:.1f} mm, the cut {:.1f} mm",
                       length, driven, longest, planned)));
    return false;
  }
  return true;
}

void RunComparison::Sample() {
  Instant start;
  start.q = replayed_.replay.targets[run_.first - 1];
  start.X_BT = ForwardFlange(cell_.arm, start.q) * cell_.X_FT;
  start.motion = run_.first;
  instants_.push_back(start);
  for (size_t i = run_.first; i <= run_.last; ++i) {
    AppendInstants(replayed_.program, cell_, replayed_.replay, i, options_.step, instants_, findings_);
  }
  for (const Instant& instant : instants_)
    driven_.push_back(BaseAt(instant.motion, instant.share) * instant.X_BT);
}

/// Every instant of the program lies on the plan's path, in order, and runs at the plan's feed.
void RunComparison::CompareForward() {
  PathFollower follower(path_, kLookAhead, options_);
  std::optional<size_t> reported, slow;
  for (size_t i = 0; i < instants_.size(); ++i) {
    const Instant& instant = instants_[i];
    if (reported == instant.motion) continue;  // it has left the plan: the rest of it tells no more
    const PathDeviation deviation = follower.Follow(driven_[i]);
    if (!deviation.Within(options_)) {
      reported = instant.motion;
      findings_.push_back(
          At(replayed_.program, instant.motion, Cause::kPath,
             fmt::format("{} leaves the plan: {}", Name(deviation.segment), deviation.Text())));
    } else if (reported != instant.motion &&
               (CompareOtherWays(instant, follower) || CompareExternal(instant, follower, deviation))) {
      reported = instant.motion;
    }
    // Feed is a property of a motion; the middle of it tells which planned one it belongs to.
    if (i > 0 && instant.share >= 0.5 && slow != instant.motion) {
      slow = instant.motion;
      CompareFeed(i, follower.segment());
    }
    Proof& proof = proofs_[instant.motion];
    proof.clearance_share = std::min(proof.clearance_share, PlanMotion(follower.segment()).clearance_share);
    if (proof.proven && LeavesProven(instant, follower)) proof.proven = false;
  }
}

/// Whether a way in which the control may also turn the tool leaves the plan where the replayed one is.
bool RunComparison::CompareOtherWays(const Instant& instant, const PathFollower& follower) {
  if (!replayed_.program.any_turn) return false;
  if (ways_of_ != instant.motion)
    ways_ = OtherWays(replayed_.program, replayed_.replay, cell_, instant.motion);
  ways_of_ = instant.motion;
  for (const ProgrammedLine& way : ways_) {
    const Pose tool =
        BaseAt(instant.motion, instant.share) *
        RealTool(replayed_.program, cell_, instant.motion, instant.share, way.At(instant.share));
    const PathDeviation deviation = follower.Off(tool);
    if (deviation.Within(options_)) continue;
    findings_.push_back(
        At(replayed_.program, instant.motion, Cause::kPath,
           fmt::format("{} leaves the plan if the control turns the tool otherwise than "
                       "replayed, which its machine data decide (ori_ipo_with_g_code in the cell): {}",
                       Name(deviation.segment), deviation.Text())));
    return true;
  }
  return false;
}

/// By how much external axis `axis` goes by in the plan while its path goes by `off`, by so much the follower
/// may be behind in `segment`.
double RunComparison::PassesBy(size_t axis, size_t segment, const PathDeviation& off) const {
  constexpr double kNoLength = 1e-3, kNoTurn = 1e-5;  // mm, rad: shorter ones tell no place
  constexpr double kText = 1e-4, kTextTurn = 1e-7;    // rounding of numbers in a text, likewise
  double most = 0;
  for (size_t s = segment; s <= std::min(segment + 1, path_.size() - 2); ++s) {
    const PoseLine line(path_[s], path_[s + 1]);
    const double way =
        PlanMotion(s).external[axis] - plan_.program.motions[plan_run_.first + s - 1].external[axis];
    double behind = 1;
    if (line.length() > kNoLength)
      behind = (off.position + kText) / line.length();
    else if (line.angle() > kNoTurn)
      behind = (std::max(off.axis, off.rotation) + kTextTurn) / line.angle();
    most = std::max(most, std::abs(way) * std::min(behind, 1.0));
  }
  return most;
}

/// Whether external axes that move along are not where the plan has them at this place of the path. On a
/// coupled axis the tip would not show it: limits and clearance were proven for the planned place.
bool RunComparison::CompareExternal(const Instant& instant, const PathFollower& follower,
                                    const PathDeviation& off) {
  if (!rides_) return false;
  const ExternalPosition given = ExternalOf(replayed_.program, instant.motion, instant.share);
  const size_t segment = follower.segment(), end = plan_run_.first + segment;
  const ExternalPosition wanted = ExternalOf(plan_.program, end, follower.share());
  for (size_t k = 0; k < given.size(); ++k) {
    const ExternalAxis& axis = plan_.program.external_axes[k];
    const double slack = PassesBy(k, segment, off);
    const bool linear = axis.kind == AxisKind::kLinear;
    if (std::abs(given[k] - wanted[k]) <=
        slack + (linear ? options_.position_tolerance : options_.angle_tolerance))
      continue;
    const double unit = linear ? 1 : kDegPerRad;
    findings_.push_back(At(replayed_.program, instant.motion, Cause::kPath,
                           fmt::format("{} leaves the plan: {}{} at {:.4f} {}, planned: {:.4f}",
                                       Name(segment), plan_rides_ ? "" : "the external axes move in a cut: ",
                                       axis.name, given[k] * unit, linear ? "mm" : "deg", wanted[k] * unit)));
    return true;
  }
  return false;
}

/// What was proven of a cut is the joint motion between its points; of approach and retract the straight
/// motion itself.
bool RunComparison::LeavesProven(const Instant& instant, const PathFollower& follower) const {
  const Joints& q = instant.q;
  const size_t end = plan_run_.first + follower.segment();
  if (plan_.program.motions[end].point < 0 || plan_.program.motions[end - 1].point < 0) return false;
  const Joints &a = plan_.replay.targets[end - 1], &b = plan_.replay.targets[end];
  const Joints along = b - a;
  const double squared = along.squaredNorm();
  double share = squared > 0 ? std::clamp((q - a).dot(along) / squared, 0.0, 1.0) : 1.0;
  if (rides_) share = follower.share();  // joints may stand still while the base moves
  double reserve = options_.clearance_reserve;
  if (rides_) {
    // The external axes were proven at the same share. What one of a rail is off moves the arm by as much; of
    // a rotary one next to nothing is let pass.
    constexpr double kSameTurn = 2e-6;  // rad: rounding of numbers in a text
    const ExternalPosition given = ExternalOf(replayed_.program, instant.motion, instant.share);
    const ExternalPosition proven = ExternalOf(plan_.program, end, share);
    for (size_t k = 0; k < given.size(); ++k) {
      const double off = std::abs(given[k] - proven[k]);
      if (plan_.program.external_axes[k].kind == AxisKind::kLinear)
        reserve -= off;
      else if (off > kSameTurn)
        return true;
    }
    if (reserve <= 0) return true;
  }
  return bodies_.MovesFurther(a + share * along, q, reserve);
}

void RunComparison::CompareFeed(size_t index, size_t segment) {
  const Instant &before = instants_[index - 1], &instant = instants_[index];
  const Motion& motion = replayed_.program.motions[instant.motion];
  const double span = instant.share - (before.motion == instant.motion ? before.share : 0);
  const Pose &from = rides_ ? driven_[index - 1] : before.X_BT, &to = rides_ ? driven_[index] : instant.X_BT;
  const double step = (to.translation() - from.translation()).norm();
  const double length = step / span;
  if (length < options_.position_tolerance) return;  // turns only
  double feed = motion.feed;
  if (motion.type == MotionType::kJoint) {
    feed = length / motion.duration;
  } else if (motion.turn_speed > 0) {
    const double turned = AngleBetween(from.linear(), to.linear()) / span;
    feed = std::min(feed, length * motion.turn_speed / std::max(turned, 1e-12));
  }
  const double wanted = PlanMotion(segment).feed;
  if (feed > wanted * options_.feed_most || feed < wanted * options_.feed_least) {
    findings_.push_back(At(replayed_.program, instant.motion, Cause::kFeed,
                           fmt::format("{} runs at {:.3f} mm/min, planned are {:.3f} mm/min", Name(segment),
                                       feed * 60, wanted * 60)));
  }
}

/// Every planned point is visited, in order.
void RunComparison::CompareBackward() {
  PathFollower follower(driven_, driven_.size(), options_);
  for (size_t k = 0; k < path_.size(); ++k) {
    const PathDeviation deviation = follower.Follow(path_[k]);
    if (deviation.Within(options_)) continue;
    const Instant& nearest = instants_[std::min(deviation.segment + 1, instants_.size() - 1)];
    findings_.push_back(At(replayed_.program, nearest.motion, Cause::kPath,
                           fmt::format("{} is not reached: {}", Name(k == 0 ? 0 : k - 1), deviation.Text())));
    return;
  }
}

/// No stop and no repeated place within the cut: both end the motion at once and mark the surface.
void RunComparison::CompareStops() {
  for (size_t i = run_.first; i < run_.last; ++i) {
    const Motion& motion = replayed_.program.motions[i];
    CompareCorner(i);
    const bool stands = (Tool(i).matrix() - Tool(i - 1).matrix()).cwiseAbs().maxCoeff() < 1e-6;
    if (stands && i > run_.first) {
      findings_.push_back(
          At(replayed_.program, i, Cause::kStop, "the motion goes nowhere: the tool stops in the cut"));
    } else if (motion.exact && !PlannedStop(i)) {
      findings_.push_back(At(replayed_.program, i, Cause::kStop, "exact stop within the cut"));
    }
  }
  ComparePlannedStops();
}

/// Every planned stop is one in the program too, in order: at the ends of approach and cut the feed and what
/// is switched rely on it.
void RunComparison::ComparePlannedStops() {
  size_t i = run_.first;
  for (size_t k = 0; k < path_.size() - 1; ++k) {
    if (!PlanMotion(k).exact) continue;
    const Pose& stop = path_[k + 1];
    const auto here = [&](size_t motion) {
      const Pose tool = Tool(motion);
      return (tool.translation() - stop.translation()).norm() <= options_.position_tolerance;
    };
    size_t found = i;
    while (found <= run_.last && !(here(found) && replayed_.program.motions[found].exact)) ++found;
    if (found <= run_.last) {
      i = found + 1;
      continue;
    }
    // The stop before may have been the run's last motion: then it is said there.
    for (found = std::min(i, run_.last); found < run_.last && !here(found);) ++found;
    findings_.push_back(At(replayed_.program, found, Cause::kStop,
                           fmt::format("{}: a stop is planned here, but not programmed", Name(k))));
    return;
  }
}

/// How far the rounding of the corner behind motion i may leave it; CheckCornerBounds() tells it of those
/// that the maker does not document.
void RunComparison::CompareCorner(size_t i) {
  const Motion& motion = replayed_.program.motions[i];
  if (motion.exact || motion.blend <= 0 || !replayed_.program.corner_assumption.empty()) return;
  const Pose before = Tool(i - 1), corner = Tool(i), after = Tool(i + 1);
  CornerRounding rounding = RoundingOf(before, corner, after, motion, replayed_.program.blend_is_distance);
  if (replayed_.program.blend_overlaps) {
    const CornerRounding overlap = OverlapAt(i);
    rounding = {std::max(rounding.position, overlap.position), std::max(rounding.angle, overlap.angle)};
  }
  if (rounding.position <= options_.position_tolerance && rounding.angle <= options_.angle_tolerance) return;
  findings_.push_back(At(replayed_.program, i, Cause::kCorner,
                         fmt::format("the corner is rounded by {:.3f} mm and {:.4f} deg", rounding.position,
                                     rounding.angle * kDegPerRad)));
}

/// What the overlap of motions i and i + 1 makes of the corner between them.
CornerRounding RunComparison::OverlapAt(size_t i) const {
  const std::vector<Joints>& targets = replayed_.replay.targets;
  const auto seconds = [&](size_t k) {
    const Motion& motion = replayed_.program.motions[k];
    if (motion.duration > 0 || motion.feed <= 0) return motion.duration;
    return (Tool(k).translation() - Tool(k - 1).translation()).norm() / motion.feed;
  };
  const double first = seconds(i), second = seconds(i + 1);
  if (first <= 0 || second <= 0) return {};
  const Motion& motion = replayed_.program.motions[i];
  AllAxes rounded =
      OverlapOf(replayed_.program, i, {targets[i - 1], targets[i], targets[i + 1], first, second},
                cell_.arm.acceleration);
  // All axes overlap for the same time, which the bound of X, Y, Z shortens.
  const double xyz = rounded.q.head<3>().norm();
  if (motion.type == MotionType::kJoint && xyz > motion.angle_blend) {
    rounded.q *= motion.angle_blend / xyz;
    for (double& off : rounded.external) off *= motion.angle_blend / xyz;
  }
  const Pose corner = Tool(i), passed = Passed(i, rounded);
  const CornerRounding overlap{(passed.translation() - corner.translation()).norm(),
                               AngleBetween(corner.linear(), passed.linear())};
  if (motion.type == MotionType::kJoint || overlap.position <= motion.blend) return overlap;
  return {motion.blend, overlap.angle * motion.blend / overlap.position};
}

Pose RunComparison::Passed(size_t i, const AllAxes& off) const {
  const Joints q = replayed_.replay.targets[i] + off.q;
  if (off.external.empty()) return ToolAt(i, 1, q);
  ExternalPosition external = replayed_.program.motions[i].external;
  for (size_t k = 0; k < external.size(); ++k) external[k] += off.external[k];
  return BaseInPart(cell_, external) * ForwardFlange(cell_.arm, q) * cell_.X_FT;
}

bool RunComparison::PlannedStop(size_t i) const {
  const Pose tool = Tool(i);
  for (size_t k = 0; k + 1 < path_.size(); ++k) {
    const bool near = (path_[k + 1].translation() - tool.translation()).norm() <= options_.position_tolerance;
    if (near && PlanMotion(k).exact) return true;
  }
  return false;
}

std::string RunComparison::Name(size_t segment) const {
  const size_t i = std::min(segment, plan_run_.last - plan_run_.first);
  const Motion& motion = PlanMotion(i);
  if (motion.point >= 0) return fmt::format("pass {}, point {}", motion.pass, motion.point);
  return fmt::format("pass {}, {}", motion.pass,
                     plan_run_.first + i < plan_run_.last ? "approach" : "retract");
}

}  // namespace millpose
