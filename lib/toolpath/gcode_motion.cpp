// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/gcode_motion.hpp"

#include "base/units.hpp"
#include "toolpath/gcode_arc.hpp"

namespace millpose {
namespace {

using Kind = GcodeWord::Kind;
using Vector = Eigen::Vector3d;

constexpr double kMaxLength = 1e7;  // mm

}  // namespace

void GcodeModes::SetFeed() {
  if (!feed_word) return;
  const double unit = inch_feed ? 25.4 : 1;
  if (feed_mode == 93) {
    inverse_time = *feed_word / 60;
    feed = 0;
    feed_word.reset();  // holds for its block
  } else {
    feed = *feed_word * unit * (feed_mode == 95 ? revolutions : 1.0 / 60);
  }
}

void GcodeMotion::TakeFrame(const GcodeBlock& block) {
  frame_.Take(block, modes_.Unit(), value_of_);
  if (!IsPlaced()) known_ = {};
  if (known_[0]) at_ = frame_.ToProgrammed(base_);
}

void GcodeMotion::SetTipProgramming(bool on) {
  if (on == tip_programmed_) return;
  if (IsPlaced()) {
    const Vector machine = tip_programmed_ ? options_.rotary_axes.Machine(base_, direction_.angles) : base_;
    base_ = on ? options_.rotary_axes.Tip(machine, direction_.angles) : machine;
    at_ = frame_.ToProgrammed(base_);
  } else {
    known_ = {};
  }
  tip_programmed_ = on;
}

void GcodeMotion::Move(const GcodeMove& move) {
  if (move.machine || move.reference) return LeaveWorkpiece(move);
  GcodeWay way;
  way.start = direction_;
  way.place = move.place;
  if (move.HasTurn()) TakeDirection(move);
  if (!move.HasLinear() && !move.HasTurn() && !move.centre[0] && !move.centre[1] && !move.centre[2]) return;
  Vector to = at_;
  for (int i = 0; i < 3; ++i) TakeCoordinate(move.linear[i], i, to);
  const bool was_known = !path_.points.empty() && !lost_;
  if (modes_.motion > 0 && !IsPlaced())
    throw InputError(move.place, "a cut before X, Y and Z have been given in this system");
  const bool travels = move.HasLinear() || modes_.motion > 1;
  if (!IsPlaced() || (!travels && !move.HasTurn())) {
    at_ = to;
    return;
  }
  way.from = at_;
  way.cut_from_known = was_known;
  if (modes_.motion > 1) {
    if (!was_known) throw InputError(way.place, "an arc needs a point before it");
    way.points = Arc(move, to);
  } else {
    way.points = {to};
  }
  Append(std::move(way));
  at_ = to;
  base_ = frame_.ToBase(at_);
  lost_ = false;
}

// Motions in machine coordinates lead away from the part: where, only the machine knows.
void GcodeMotion::LeaveWorkpiece(const GcodeMove& move) {
  for (int i = 0; i < 3; ++i)
    if (move.linear[i] || move.reference) known_[i] = false;
  for (int i = 0; i < 3; ++i)
    if (move.rotary[i]) direction_.angles[i] = DegToRad(value_of_(*move.rotary[i]));
  SetAxis();
  if (move.HasLinear() || move.reference || move.HasTurn()) lost_ = fresh_ = true;
}

bool GcodeMotion::IsStep(const GcodeWord& word) const {
  return word.kind == Kind::kIncremental || (modes_.incremental && word.kind != Kind::kAbsolute);
}

void GcodeMotion::TakeCoordinate(const GcodeWord* word, int i, Vector& to) {
  if (!word) return;
  const double value = value_of_(*word) * modes_.Unit();
  if (!(std::abs(value) <= kMaxLength))
    throw InputError(word->place, fmt::format("{} mm is beyond ±{} mm", value, kMaxLength));
  const bool step = IsStep(*word);
  if (step && !known_[i]) throw InputError(word->place, "a step from a place that is not known");
  to[i] = step ? at_[i] + value : value;
  known_[i] = true;
}

// Rotary axes and tool vectors; either replaces the other.
void GcodeMotion::TakeDirection(const GcodeMove& move) {
  if (move.vector[0] || move.vector[1] || move.vector[2]) return TakeVector(move);
  for (size_t i = 0; i < 3; ++i) {
    const GcodeWord* word = move.rotary[i];
    if (!word) continue;
    const double value = value_of_(*word);
    if (!(std::abs(value) <= 1e5)) throw InputError(word->place, "an angle beyond ±100000 degrees");
    const bool step = IsStep(*word);
    double& angle = direction_.angles[i];
    angle = DegToRad(value) + (step ? angle : 0);
    const char letter = "ABC"[i];
    if (angle != 0 && !options_.rotary_axes.Has(letter))
      throw InputError(word->place,
                       fmt::format("the programme turns axis {0}, and toolpath.cam.rotary_axes does not "
                                   "state an axis {0}",
                                   letter));
  }
  direction_.by_vector = false;
  SetAxis();
}

void GcodeMotion::TakeVector(const GcodeMove& move) {
  Vector vector = Vector::Zero();
  const GcodeWord* any = nullptr;
  for (int i = 0; i < 3; ++i)
    if (move.vector[i]) {
      vector[i] = value_of_(*move.vector[i]);
      any = move.vector[i];
    }
  if (!(vector.norm() > 1e-6 && vector.norm() < 1e6))
    throw InputError(any->place, "the tool vector has no length");
  direction_.axis = (frame_.linear() * vector).normalized();
  direction_.by_vector = true;
}

void GcodeMotion::SetAxis() {
  if (!direction_.by_vector) direction_.axis = options_.rotary_axes.ToolAxis(direction_.angles);
}

std::vector<Vector> GcodeMotion::Arc(const GcodeMove& move, const Vector& to) {
  GcodeArc arc;
  arc.from = at_;
  arc.to = to;
  arc.plane = modes_.plane;
  arc.counter_clockwise = modes_.motion == 3;
  for (size_t i = 0; i < 3; ++i)
    if (const GcodeWord* word = move.centre[i]) {
      arc.centre[i] = value_of_(*word) * modes_.Unit();
      arc.absolute[i] =
          word->kind == Kind::kAbsolute || (modes_.absolute_centre && word->kind != Kind::kIncremental);
    }
  if (move.radius) arc.radius = value_of_(*move.radius) * modes_.Unit();
  if (move.turns) arc.full_turns = value_of_(*move.turns);
  arc.place = move.place;
  ++arcs_;
  return PointsOf(arc, options_.chord_tolerance);
}

void GcodeMotion::Append(GcodeWay way) {
  way.end = direction_;
  way.tip_programmed = tip_programmed_;
  way.rapid = modes_.motion == 0;
  way.feed = modes_.feed;
  way.inverse_time = std::exchange(modes_.inverse_time, 0);
  if (modes_.feed_mode == 93 && !way.rapid && way.inverse_time == 0)
    throw InputError(way.place, "under G93 each cut needs its F");
  const size_t first = path_.points.size();
  AppendWay(way, frame_, options_, path_);
  path_.points[first].fresh = std::exchange(fresh_, false) && first > 0;
}

}  // namespace millpose
