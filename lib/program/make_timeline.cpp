// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/make_timeline.hpp"

#include "base/units.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

const double kJointStep = DegToRad(5);  // between instants of a joint motion, at most
constexpr double kTipStep = 25;         // mm, between instants of an approach or retract, at most
constexpr int kRampParts = 4;           // of speeding up, and of slowing down

/// A planned end of a piece: the first point, or the last.
struct SegmentEnd {
  const PassResult* pass;
  size_t point;
};

SegmentEnd EndOf(const PlanResult& plan, int pass_number, int piece_number, bool last) {
  const PassResult& pass = plan.passes[static_cast<size_t>(pass_number)];
  const auto piece = std::ranges::find(pass.pieces, piece_number, &Segment::piece);
  assert(piece != pass.pieces.end());
  const bool backwards = last && !piece->closed;
  int at = backwards ? piece->last : piece->first;
  while (pass.points[static_cast<size_t>(at)].skip != Infeasibility::kNone) at += backwards ? -1 : 1;
  return {&pass, static_cast<size_t>(at)};
}

/// The joints there, or at home (−1).
Joints JointsAt(const PlanResult& plan, int pass, int piece, bool last) {
  if (pass < 0) return plan.home;
  const SegmentEnd end = EndOf(plan, pass, piece, last);
  return end.pass->points[end.point].q;
}

/// Where the external axes are there, or at home (−1).
ExternalPosition StationOf(const PlanResult& plan, int pass, int piece, bool last) {
  if (pass < 0) return Mechanism(plan.external_axes).Home();
  const SegmentEnd end = EndOf(plan, pass, piece, last);
  return ExternalAt(*end.pass, end.point);
}

/// The plan with a leap in place of every gap that could not be planned.
PlanResult WithLeaps(const PlanResult& plan) {
  PlanResult whole = plan;
  for (LinkMove& gap : whole.gaps) {
    if (gap.planned) continue;
    gap.joints = {JointsAt(plan, gap.from_pass, gap.from_piece, true),
                  JointsAt(plan, gap.to_pass, gap.to_piece, false)};
    const ExternalPosition from = StationOf(plan, gap.from_pass, gap.from_piece, true),
                           to = StationOf(plan, gap.to_pass, gap.to_piece, false);
    if (from != to) gap.external = ExternalMove{from, to};
    gap.planned = true;
  }
  return whole;
}

/// One less than the gap has corners, and one more where the external axes move.
size_t JointMotions(const LinkMove& gap) { return gap.joints.size() - 1 + (gap.external ? 1 : 0); }

/// For every motion, whether it belongs to a gap that could not be planned. Joint motions come gap by gap;
/// the very first goes home.
std::vector<char> FindLeaps(const PlanResult& plan, const PlanResult& whole, const MotionProgram& program) {
  std::vector<char> leaps(program.motions.size(), 0);
  size_t gap = 0, left = JointMotions(whole.gaps.front());
  for (size_t i = 1; i < leaps.size(); ++i) {
    if (program.motions[i].type != MotionType::kJoint) continue;
    while (left == 0) left = JointMotions(whole.gaps.at(++gap));
    leaps[i] = !plan.gaps[gap].planned;
    --left;
  }
  return leaps;
}

/// In how many parts of kTipStep or kJointStep the way of the external axes comes.
double ExternalParts(const MotionProgram& program, size_t i) {
  double parts = 0;
  for (size_t k = 0; k < program.external_axes.size(); ++k) {
    const double way = std::abs(program.motions[i].external[k] - program.motions[i - 1].external[k]);
    parts =
        std::max(parts, way / (program.external_axes[k].kind == AxisKind::kLinear ? kTipStep : kJointStep));
  }
  return parts;
}

/// The times within a motion at which it is looked at, beside its end: the ramps and evenly between.
std::vector<double> TimesWithin(const TimeLaw& law, double parts) {
  std::vector<double> times;
  const double ramp = law.acceleration > 0 ? law.speed / law.acceleration : 0;
  const double rise = law.from_rest ? ramp : 0, fall = law.to_rest ? ramp : 0;
  const double even = std::max(0.0, law.duration - rise - fall);
  const auto add = [&](double from, double length, int count) {
    for (int k = 0; k < count && length > 0; ++k) times.push_back(from + length * k / count);
  };
  add(0, rise, kRampParts);
  add(rise, even, std::max(1, static_cast<int>(std::ceil(parts))));
  add(law.duration - fall, fall, kRampParts);
  if (!times.empty()) times.erase(times.begin());  // the end of the motion before
  return times;
}

}  // namespace

RunPart PartOf(const PlanResult& plan, const MotionProgram& program, size_t i) {
  const Motion& motion = program.motions[i];
  if (MovesExternal(program, i) && !HasFeed(motion)) return RunPart::kExternal;
  if (motion.type == MotionType::kJoint) return RunPart::kLinkMove;
  if (motion.point < 0) return program.motions[i - 1].point >= 0 ? RunPart::kRetract : RunPart::kApproach;
  if (!IsCut(program, i)) return RunPart::kApproach;
  const PlannedPoint& point =
      plan.passes[static_cast<size_t>(motion.pass)].points[static_cast<size_t>(motion.point)];
  return point.point.kind == PointKind::kCut ? RunPart::kCut : RunPart::kLead;
}

Timeline MakeTimeline(const PlanResult& plan, MotionOptions options, const TimeOptions& times) {
  Timeline timeline;
  if (plan.gaps.empty()) return timeline;
  options.calls.clear();
  std::optional<PlanResult> leaping;  // a copy of the plan: made only where it differs
  if (!std::ranges::all_of(plan.gaps, &LinkMove::planned)) leaping = WithLeaps(plan);
  const PlanResult& whole = leaping ? *leaping : plan;
  const MotionProgram program = MakeMotionProgram(whole, options);
  const std::vector<TimeLaw> laws = TimeMotions(program, plan.arm, times);
  const std::vector<double> dwells = Dwells(program);
  const std::vector<char> leaps = FindLeaps(plan, whole, program);
  double start = 0;
  for (size_t i = 0; i < laws.size(); ++i) {
    const Motion& motion = program.motions[i];
    const RunPart stretch = leaps[i] ? RunPart::kMissing : PartOf(plan, program, i);
    const auto add = [&](double time, double share) {
      ExternalPosition external = ExternalOf(program, i, share);
      const Pose X_WP = external.empty() ? plan.X_WP : BaseAt(plan, external) * FrameAt(program, i, share);
      timeline.push_back({.time = time,
                          .q = JointsOf(program, plan.arm, i, share),
                          .external = std::move(external),
                          .tip = (X_WP * TipOf(program, plan.arm, i, share)).translation(),
                          .stretch = stretch,
                          .pass = motion.pass,
                          .point = share < 1 ? -1 : motion.point});
    };
    if (stretch != RunPart::kMissing && stretch != RunPart::kCut && stretch != RunPart::kLead && i > 0) {
      const double turn = (*motion.q - *program.motions[i - 1].q).cwiseAbs().maxCoeff();
      const double length = (motion.X_PT.translation() - program.motions[i - 1].X_PT.translation()).norm();
      const double parts = stretch == RunPart::kExternal   ? ExternalParts(program, i)
                           : stretch == RunPart::kLinkMove ? turn / kJointStep
                                                           : length / kTipStep;
      for (const double time : TimesWithin(laws[i], parts)) add(start + time, laws[i].Share(time));
    }
    if (stretch != RunPart::kMissing) start += laws[i].duration;
    add(start, 1);
    if (dwells[i] > 0) add(start += dwells[i], 1);
  }
  return timeline;
}

}  // namespace millpose
