// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/motion_program.hpp"

#include <cassert>

#include "robot/kinematics.hpp"

namespace millpose {
namespace {

/// Appends motions and events of one plan.
class ProgramBuilder {
 public:
  explicit ProgramBuilder(const PlanResult& plan) : plan_(plan), X_PB_(plan.X_WP.inverse() * plan.X_WB) {
    program_.name = plan.job;
    program_.header = {{"job", plan.job}, {"cell", plan.cell}, {"inputs", plan.input_hash}};
    program_.X_BP = plan.X_WB.inverse() * plan.X_WP;
    program_.X_FT = plan.X_FT;
  }

  void AddGap(const Gap& gap) {
    assert(!gap.joints.empty());
    if (gap.from_pass >= 0) {
      Add(MotionType::kLinear, gap.joints.front(), gap.from_pass, -1).exact = true;
      program_.motions.back().feed = last_feed_;
      AddEvent(ProgramEvent::Kind::kPassEnd, gap.from_pass, gap.from_piece);
    } else {
      Add(MotionType::kJoint, gap.joints.front(), -1, -1).exact = true;
    }
    if (gap.to_pass < 0) AddEvent(ProgramEvent::Kind::kSpindleOff, 0, 0);
    for (size_t i = 1; i < gap.joints.size(); ++i) {
      if (gap.to_pass >= 0 && i + 1 == gap.joints.size()) break;
      Add(MotionType::kJoint, gap.joints[i], -1, -1).exact = true;
    }
    if (gap.to_pass >= 0) AddEntry(gap);
  }

  void AddPiece(const PassResult& pass, const Piece& piece) {
    const size_t approach = program_.motions.size();
    for (int i = piece.first; i <= piece.last; ++i) {
      if (pass.points[i].skip == SkipReason::kNone) AddCut(pass, i);
    }
    assert(program_.motions.size() > approach);
    if (piece.closed) AddCut(pass, program_.motions[approach].point);
    program_.motions[approach].exact = true;
    program_.motions.back().exact = true;
  }

  MotionProgram Take() { return std::move(program_); }

 private:
  Motion& Add(MotionType type, const Joints& q, int pass, int point) {
    Motion& motion = program_.motions.emplace_back();
    motion.type = type;
    motion.q = q;
    motion.X_PT = X_PB_ * ForwardFlange(plan_.arm, q) * plan_.X_FT;
    motion.pass = pass;
    motion.point = point;
    return motion;
  }

  Motion& AddCut(const PassResult& pass, int i) {
    Motion& motion = Add(MotionType::kLinear, pass.points[i].q, pass.pass, i);
    motion.feed = last_feed_ = pass.points[i].point.feed_rate;
    return motion;
  }

  /// Where the approach of a piece begins: a PTP with S and T, from which the piece can be entered.
  void AddEntry(const Gap& gap) {
    AddEvent(ProgramEvent::Kind::kPassBegin, gap.to_pass, gap.to_piece);
    Motion& entry = Add(MotionType::kJoint, gap.joints.back(), gap.to_pass, -1);
    entry.exact = true;
    entry.status = Status(plan_.arm, gap.joints.back());
    entry.turn = Turn(gap.joints.back());
    if (gap.from_pass < 0) AddEvent(ProgramEvent::Kind::kSpindleOn, plan_.spindle_speed, 0);
  }

  void AddEvent(ProgramEvent::Kind kind, double value, int piece) {
    program_.events.push_back({kind, program_.motions.size(), value, piece, 0, 0});
  }

  const PlanResult& plan_;
  Pose X_PB_;
  MotionProgram program_;
  double last_feed_ = 0;
};

const Piece& FindPiece(const PassResult& pass, int number) {
  const auto found = std::find_if(pass.pieces.begin(), pass.pieces.end(),
                                  [&](const Piece& piece) { return piece.piece == number; });
  assert(found != pass.pieces.end());
  return *found;
}

}  // namespace

std::string WhyNotProgrammable(const PlanResult& plan) {
  if (plan.gaps.empty()) return "no piece was planned";
  for (const Gap& gap : plan.gaps) {
    if (gap.planned) continue;
    const auto name = [](int pass, int piece) {
      return pass < 0 ? std::string("home") : fmt::format("pass {} piece {}", pass, piece);
    };
    return fmt::format("the way from {} to {} could not be planned: {}", name(gap.from_pass, gap.from_piece),
                       name(gap.to_pass, gap.to_piece), gap.detail);
  }
  return {};
}

MotionProgram MakeMotionProgram(const PlanResult& plan) {
  assert(WhyNotProgrammable(plan).empty());
  ProgramBuilder builder(plan);
  for (const Gap& gap : plan.gaps) {
    builder.AddGap(gap);
    if (gap.to_pass >= 0) {
      builder.AddPiece(plan.passes[gap.to_pass], FindPiece(plan.passes[gap.to_pass], gap.to_piece));
    }
  }
  return builder.Take();
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
