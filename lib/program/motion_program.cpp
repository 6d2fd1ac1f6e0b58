// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/motion_program.hpp"

#include <cassert>

#include "base/error.hpp"
#include "machine/motion/line.hpp"
#include "machine/robot/angles.hpp"
#include "machine/robot/kinematics.hpp"
#include "machine/robot/position_between.hpp"
#include "planning/result/skipped.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

constexpr size_t kOfMove = 5;  // motions beside its way-points: approach, entry, retract, a ring's closing
constexpr double kShortest = 0.05;  // mm: a shorter part of an approach would be lost in a program's decimals
constexpr double kTurnsBack = -0.9;  // cosine between two motions: a turn by more than 154°
constexpr double kSlower = 0.5;      // share of its feed that a tool goes on with
constexpr double kSpeedShare = 0.5;  // of the joints' largest speeds that approach and retract may use

/// Appends motions and events of one plan.
class ProgramBuilder {
 public:
  ProgramBuilder(const PlanResult& plan, const MotionOptions& options) : plan_(plan), options_(options) {
    StandAt(Mechanism(plan.external_axes).Home());
    program_.name = plan.job;
    program_.notice = options.notice;
    program_.header = {{"job", plan.job}, {"cell", plan.cell}, {"inputs", plan.input_hash}};
    program_.header.insert(program_.header.end(), options.header.begin(), options.header.end());
    program_.external_axes = plan.external_axes;
    if (!plan.external_axes.empty()) program_.X_WB = plan.X_WB;
    program_.X_BP = plan.X_WB.inverse() * plan.X_WP;
    program_.X_FT = plan.X_FT;
    size_t moves = 0;
    for (const LinkMove& gap : plan.gaps) moves += gap.joints.size() + kOfMove;
    program_.motions.reserve(CountPoints(plan) + moves);
  }

  /// From home by a call's way to where it begins, the call, and back.
  void AddCalls(bool at_end) {
    for (const CallTransition& way : options_.calls) {
      if ((way.call.text == "footer") != at_end) continue;
      clearance_share_ = way.clearance_share;
      for (size_t i = program_.motions.empty() ? 0 : 1; i < way.there.size(); ++i)
        Add(MotionType::kJoint, way.there[i], -1, -1).exact = true;
      Motion& call = Add(MotionType::kJoint, way.call.to, -1, -1);
      call.exact = true;
      call.call = static_cast<int>(program_.calls.size());
      program_.calls.push_back(way.call);
      for (size_t i = 1; i < way.back.size(); ++i) Add(MotionType::kJoint, way.back[i], -1, -1).exact = true;
    }
  }

  void AddLinkMove(const LinkMove& gap) {
    assert(!gap.joints.empty());
    clearance_share_ = gap.clearance_share;
    if (gap.from_pass >= 0) {
      const Motion last = program_.motions.back();
      Motion& retract = Add(MotionType::kLinear, gap.joints.front(), gap.from_pass, -1);
      retract.exact = true;
      retract.feed = FeedOf(last, retract, options_.retract_feed > 0 ? options_.retract_feed : last.feed);
      AddEvent(ProgramEvent::Kind::kPassEnd, gap.from_pass, gap.from_piece);
    } else if (program_.motions.empty()) {
      Add(MotionType::kJoint, gap.joints.front(), -1, -1).exact = true;
    }
    const bool stands = gap.to_pass < 0 || (gap.external && gap.from_pass >= 0);
    if (stands) AddEvent(ProgramEvent::Kind::kSpindleOff, 0, 0);
    for (size_t i = 0; i < gap.joints.size(); ++i) {
      if (gap.to_pass >= 0 && i + 1 == gap.joints.size()) break;
      if (i > 0) Add(MotionType::kJoint, gap.joints[i], -1, -1).exact = true;
      if (!gap.external || static_cast<int>(i) != gap.external->at) continue;
      StandAt(gap.external->to);
      Add(MotionType::kJoint, gap.joints[i], -1, -1).exact = true;
    }
    if (gap.to_pass >= 0) AddEntry(gap);
  }

  void AddSegment(const PassResult& pass, const Segment& piece) {
    int first = piece.first;
    while (pass.points[first].skip != Infeasibility::kNone) ++first;
    assert(first <= piece.last);
    AddApproach(pass, first);
    AddPlunge(pass, first);
    AddOutputs(true);
    clearance_share_ = 1;
    const size_t plunge = program_.motions.size() - 1;
    for (int i = first + 1; i <= piece.last; ++i) {
      if (pass.points[i].skip == Infeasibility::kNone) AddCut(pass, i);
    }
    if (piece.closed) AddClosing(pass, first);
    program_.motions.back().exact = true;
    StopWhereItTurnsBack(plunge);
    AddOutputs(false);
  }

  MotionProgram Take() { return std::move(program_); }

 private:
  /// The motions that follow are made at this station.
  void StandAt(const ExternalPosition& external) {
    external_ = external;
    X_BP_ = BaseAt(plan_, external).inverse() * PartAt(plan_, external);
    X_PB_ = PartAt(plan_, external).inverse() * BaseAt(plan_, external);
  }

  Motion& Add(MotionType type, const Joints& q, int pass, int point) {
    Motion& motion = program_.motions.emplace_back();
    motion.type = type;
    motion.q = q;
    motion.external = external_;
    if (!external_.empty()) motion.X_BP = X_BP_;
    motion.X_PT = X_PB_ * ForwardFlange(plan_.arm, q) * plan_.X_FT;
    motion.pass = pass;
    motion.point = point;
    motion.clearance_share = clearance_share_;
    return motion;
  }

  Motion& AddCut(const PassResult& pass, int i) {
    const MillingPoint& point = pass.points[i].point;
    const Pose X_BP_before = X_BP_;
    const bool rides = pass.points[i].external && *pass.points[i].external != external_;
    if (rides) StandAt(*pass.points[i].external);
    Motion& motion = Add(MotionType::kLinear, pass.points[i].q, pass.pass, i);
    if (rides) motion.X_BP_begin = X_BP_before;
    motion.feed = point.feed_rate;
    if (point.kind == PointKind::kLeadIn) motion.feed = std::min(motion.feed, PlungeFeed(point));
    return motion;
  }

  /// Back to a ring's first point, with the full revolutions that the way round has made.
  void AddClosing(const PassResult& pass, int first) {
    const Joints before = *program_.motions.back().q;
    Motion& closing = AddCut(pass, first);
    closing.q = NearestEquivalent(before, *closing.q);
  }

  /// Rounded, a way that leads back over itself would end short of the place where it turns; and a tool that
  /// goes down fast in its hole must be slow before it meets the material.
  void StopWhereItTurnsBack(size_t plunge) {
    size_t last = 0;
    for (size_t i = plunge + 1; i + 1 < program_.motions.size(); ++i) {
      const auto at = [&](size_t k) -> Eigen::Vector3d { return program_.motions[k].X_PT.translation(); };
      const Eigen::Vector3d in = at(i) - at(i - 1), out = at(i + 1) - at(i);
      Motion& motion = program_.motions[i];
      const bool down = in.dot(motion.X_PT.linear().col(2)) < kTurnsBack * in.norm();
      const bool slower = program_.motions[i + 1].feed < kSlower * motion.feed;
      if (down && slower) motion.exact = true;
      if (in.dot(out) >= kTurnsBack * in.norm() * out.norm()) continue;
      motion.exact = true;
      last = i;
    }
    if (options_.dwell <= 0 || last == 0) return;
    AddEvent(ProgramEvent::Kind::kDwell, options_.dwell, 0);
    program_.events.back().before_motion = last + 1;
  }

  /// mm/s of motions towards material that end at a cut's point.
  double PlungeFeed(const MillingPoint& point) const {
    return options_.plunge_feed > 0 ? options_.plunge_feed : point.feed_rate;
  }

  /// The part of the approach to a pass's point before its last `approach_slow`.
  void AddApproach(const PassResult& pass, int point) {
    const Motion entry = program_.motions.back();
    const PlannedPoint& target = pass.points[point];
    const PoseLine line(entry.X_PT, X_PB_ * ForwardFlange(plan_.arm, target.q) * plan_.X_FT);
    const double before = line.length() - options_.approach_slow;
    const double feed = options_.approach_feed;
    if (feed <= 0 || feed == PlungeFeed(target.point) || options_.approach_slow <= 0 || before < kShortest)
      return;
    const auto q =
        InverseNear(plan_.arm, X_PB_.inverse() * line.At(before / line.length()) * plan_.X_FT.inverse(),
                    Status(plan_.arm, target.q), target.q);
    if (!q) return;
    Motion& approach = Add(MotionType::kLinear, *q, pass.pass, -1);
    approach.exact = true;
    approach.feed = FeedOf(entry, approach, feed);
  }

  /// The last part of the approach, into the material.
  void AddPlunge(const PassResult& pass, int point) {
    const Motion before = program_.motions.back();
    Motion& plunge = AddCut(pass, point);
    plunge.exact = true;
    plunge.feed = FeedOf(before, plunge, PlungeFeed(pass.points[point].point));
  }

  /// The feed of a straight motion beside the cut: `wanted`, as far as the joints can follow.
  double FeedOf(const Motion& from, const Motion& to, double wanted) const {
    const double share = (*to.q - *from.q).cwiseAbs().cwiseQuotient(plan_.arm.speed).maxCoeff();
    const double length = (to.X_PT.translation() - from.X_PT.translation()).norm();
    return share > 0 ? std::min(wanted, kSpeedShare * length / share) : wanted;
  }

  /// Where the approach of a piece begins: a PTP with S and T, from which the piece can be entered.
  void AddEntry(const LinkMove& gap) {
    AddEvent(ProgramEvent::Kind::kPassBegin, gap.to_pass, gap.to_piece);
    Motion& entry = Add(MotionType::kJoint, gap.joints.back(), gap.to_pass, -1);
    entry.exact = true;
    entry.status = Status(plan_.arm, gap.joints.back());
    entry.turn = Turn(gap.joints.back());
    if (gap.from_pass < 0 || gap.external) AddEvent(ProgramEvent::Kind::kSpindleOn, plan_.spindle_speed, 0);
  }

  void AddEvent(ProgramEvent::Kind kind, double value, int piece) {
    program_.events.push_back({kind, program_.motions.size(), value, piece, {}, 0, 0});
  }

  void AddOutputs(bool at_begin) {
    for (const PathOutput& output : options_.outputs) {
      if (output.at_begin != at_begin) continue;
      AddEvent(ProgramEvent::Kind::kOutput, 0, 0);
      program_.events.back().output = output;
    }
  }

  const PlanResult& plan_;
  const MotionOptions& options_;
  ExternalPosition external_;  // of the station
  Pose X_BP_, X_PB_;           // there
  MotionProgram program_;
  double clearance_share_ = 1;
};

const Segment& FindSegment(const PassResult& pass, int number) {
  const auto found = std::find_if(pass.pieces.begin(), pass.pieces.end(),
                                  [&](const Segment& piece) { return piece.piece == number; });
  assert(found != pass.pieces.end());
  return *found;
}

}  // namespace

std::string WhyNotProgrammable(const PlanResult& plan) {
  if (plan.gaps.empty()) return "no piece was planned";
  for (const LinkMove& gap : plan.gaps) {
    if (gap.planned) continue;
    const auto name = [](int pass, int piece) {
      return pass < 0 ? std::string("home") : fmt::format("pass {} piece {}", pass, piece);
    };
    return fmt::format("the way from {} to {} could not be planned: {}", name(gap.from_pass, gap.from_piece),
                       name(gap.to_pass, gap.to_piece), gap.detail);
  }
  return {};
}

PlanResult Lifted(PlanResult plan, double offset) {
  const Pose lift = plan.X_FT * Eigen::Translation3d(0, 0, offset) * plan.X_FT.inverse();
  std::vector<Problem> problems;
  for (PassResult& pass : plan.passes) {
    for (size_t i = 0; i < pass.points.size(); ++i) {
      PlannedPoint& point = pass.points[i];
      if (point.skip != Infeasibility::kNone) continue;
      const auto q =
          InverseNear(plan.arm, ForwardFlange(plan.arm, point.q) * lift, Status(plan.arm, point.q), point.q);
      if (q) {
        point.q = *q;
      } else {
        problems.push_back(
            {SourceLocation{}, fmt::format("dry run: pass {} point {} is out of reach when lifted by {} mm",
                                           pass.pass, i, offset)});
      }
    }
  }
  if (!problems.empty()) throw InputError(problems);
  return plan;
}

MotionProgram MakeMotionProgram(const PlanResult& plan, const MotionOptions& options) {
  assert(WhyNotProgrammable(plan).empty());
  ProgramBuilder builder(plan, options);
  builder.AddCalls(false);
  for (const LinkMove& gap : plan.gaps) {
    builder.AddLinkMove(gap);
    if (gap.to_pass >= 0) {
      builder.AddSegment(plan.passes[gap.to_pass], FindSegment(plan.passes[gap.to_pass], gap.to_piece));
    }
  }
  builder.AddCalls(true);
  return builder.Take();
}

std::string HeaderValue(const MotionProgram& program, const std::string& key) {
  std::string whole;
  for (const auto& [name, value] : program.header)
    if (name == key) whole += (whole.empty() ? "" : " ") + value;
  return whole;
}

bool MovesExternal(const MotionProgram& program, size_t i) {
  return i > 0 && program.motions[i].external != program.motions[i - 1].external;
}

bool CoordinatedMotions(const MotionProgram& program, size_t i) {
  return HasFeed(program.motions[i]) && MovesExternal(program, i);
}

bool HasCoordinatedMotions(const MotionProgram& program) {
  for (size_t i = 1; i < program.motions.size(); ++i)
    if (CoordinatedMotions(program, i)) return true;
  return false;
}

ExternalPosition ExternalOf(const MotionProgram& program, size_t i, double share) {
  const ExternalPosition& external = program.motions[i].external;
  return MovesExternal(program, i) ? PositionBetween(program.motions[i - 1].external, external, share)
                                   : external;
}

Pose BaseOnPart(const MotionProgram& program, const ExternalPosition& external) {
  const Mechanism mechanism(program.external_axes);
  return mechanism.Moved(Carries::kWorkpiece, external).inverse(Eigen::Isometry) *
         mechanism.Moved(Carries::kRobot, external) * program.X_WB;
}

Pose FrameAt(const MotionProgram& program, size_t i, double share) {
  const Motion& motion = program.motions[i];
  Pose X_BP = *FrameOf(program, motion);
  if (!motion.X_BP_begin || share >= 1) return X_BP;
  if (share <= 0) return *motion.X_BP_begin;
  // Carried by the axes as the cell has them, the frame is one and the same on the part; a controller that
  // has measured them otherwise brings it from one place to another.
  const PoseLine carried(BaseOnPart(program, program.motions[i - 1].external) * *motion.X_BP_begin,
                         BaseOnPart(program, motion.external) * X_BP);
  return BaseOnPart(program, ExternalOf(program, i, share)).inverse(Eigen::Isometry) * carried.At(share);
}

bool HasFeed(const Motion& motion) { return motion.type == MotionType::kLinear || motion.duration > 0; }

std::vector<double> Dwells(const MotionProgram& program) {
  std::vector<double> dwells(program.motions.size(), 0);
  for (const ProgramEvent& event : program.events)
    if (event.kind == ProgramEvent::Kind::kDwell && event.before_motion > 0)
      dwells[event.before_motion - 1] += event.value;
  return dwells;
}

bool IsWellFormed(const MotionProgram& program) {
  size_t last = 0;
  for (const ProgramEvent& event : program.events) {
    if (event.before_motion < last || event.before_motion > program.motions.size()) return false;
    last = event.before_motion;
  }
  return true;
}

}  // namespace millpose
