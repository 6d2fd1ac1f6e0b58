// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/gcode_motion.hpp"

#include "base/units.hpp"
#include "toolpath/cam/gcode_arc.hpp"

namespace millpose {
namespace {

using Kind = GcodeWord::Kind;
using Vector = Eigen::Vector3d;

constexpr double kMaxLength = 1e7;  // mm

}  // namespace

void GcodeMotion::TakeFrame(const GcodeBlock& block) {
  frame_.Take(block, modes_.Unit(), value_of_);
  if (!IsPlaced()) known_ = {};
  if (known_[0]) at_ = frame_.ToProgrammed(base_);
}

void GcodeMotion::SetOffset(const std::string& name, const SourceLocation& place) {
  const bool again = offset_named_ && name == offset_;
  const std::string before = offset_;
  const bool named_before = std::exchange(offset_named_, true);
  offset_ = name;
  if (!options_.offsets.empty()) {
    const auto stated = options_.offsets.find(name);
    if (stated == options_.offsets.end())
      throw InputError(place, name + " is not among toolpath.cam.offsets_mm");
    frame_.SetOffset(stated->second);
    if (IsPlaced()) at_ = frame_.ToProgrammed(base_);
    cut_in_offset_ = false;
    return;
  }
  if (again || (!named_before && name == before)) return;
  if (cut_in_offset_)
    throw InputError(
        place,
        fmt::format(
            "{} behind cuts under {}{}: where the two lie to each other is known to the control alone. "
            "State toolpath.cam.offsets_mm, e.g. {{{}: [0, 0, 0], {}: [250, 0, 0]}}, where the zero of "
            "each lies in the workpiece frame",
            name, before, named_before ? "" : " (in force where none is named)", before, name));
  known_ = {};  // the rapids before were counted from elsewhere
}

// The first cut under an offset.
void GcodeMotion::UseOffset(const SourceLocation& place) {
  if (options_.offsets.empty()) return;
  if (!options_.offsets.contains(offset_))
    throw InputError(place, fmt::format("a cut under {}, which is not among toolpath.cam.offsets_mm",
                                        offset_.empty() ? "no zero offset" : offset_));
  path_.keys_used.insert("offsets_mm." + offset_);
}

void GcodeMotion::ShiftDatum(const GcodeMove& move) {
  if (modes_.incremental) throw InputError(move.place, "a datum shift in steps (G91) is not read");
  for (int i = 0; i < 3; ++i)
    if (const GcodeWord* word = move.linear[static_cast<size_t>(i)])
      datum_[i] = value_of_(*word) * modes_.Unit();
  frame_.Shift(datum_);
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
  GcodePath way;
  way.start = direction_;
  way.place = move.place;
  if (move.HasTurn()) TakeDirection(move);
  const bool arc = modes_.motion > 1 && (move.HasCentre() || move.pole || move.radius);
  if (!move.HasLinear() && !move.HasTurn() && !arc) return;
  Vector to = at_;
  for (int i = 0; i < 3; ++i) TakeCoordinate(move.linear[i], i, to);
  const bool was_known = !path_.points.empty() && !lost_;
  if (modes_.motion > 0 && !IsPlaced())
    throw InputError(move.place, "a cut before X, Y and Z have been given in this system");
  const bool travels = move.HasLinear() || arc;
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
  Append(std::move(way), modes_.motion == 0);
  at_ = to;
  base_ = frame_.ToBase(at_);
  lost_ = false;
}

void GcodeMotion::Turn(const GcodeMove& move) { TakeDirection(move); }

Vector GcodeMotion::TipAt(const Vector& programmed) const {
  const Vector base = frame_.ToBase(programmed);
  return tip_programmed_ ? base : options_.rotary_axes.Tip(base, direction_.angles);
}

void GcodeMotion::AppendStraight(const Vector& to, bool rapid, const SourceLocation& place) {
  GcodePath way;
  way.start = direction_;
  way.place = place;
  way.from = at_;
  way.points = {to};
  Append(std::move(way), rapid);
  at_ = to;
  base_ = frame_.ToBase(at_);
}

void GcodeMotion::Drill(const GcodeMove& move, const GcodeHole& hole) {
  constexpr double kAlong = 0.9999984769132877;  // cosine of 0.1 degrees
  const int k = DrillingAxis();
  Vector to = at_;
  for (int i = 0; i < 3; ++i)
    if (i != k) TakeCoordinate(move.linear[static_cast<size_t>(i)], i, to);
  if (!IsPlaced()) throw InputError(hole.place, "a cycle before X, Y and Z have been given in this system");
  if (modes_.feed_mode == 93) throw InputError(hole.place, "a cycle under G93 is not read");
  const auto at_height = [&](double height) {
    Vector p = to;
    p[k] = height;
    return p;
  };
  Vector below = at_height(hole.clearance);
  below[k] -= 1;
  const Vector out = TipAt(at_height(hole.clearance)) - TipAt(below);
  std::string why = hole.left_out;
  if (why.empty() && !(out.normalized().dot(direction_.axis) >= kAlong))
    why = "the tool does not stand along the hole";
  if (!why.empty()) {
    path_.holes_left_out.push_back({TipAt(at_height(hole.clearance)), hole.name, why, hole.place.line});
    sections_.Stamp(path_.holes_left_out.back());
    if (!std::exchange(cut_in_offset_, true)) UseOffset(hole.place);
    fresh_ = true;
  } else {
    AppendStraight(at_height(hole.clearance), true, hole.place);
    const double feed = modes_.feed;
    modes_.feed = feed * hole.first_feed_share;
    for (const double height : hole.strokes) {
      AppendStraight(at_height(height), false, hole.place);
      modes_.feed = feed;
    }
    ++holes_;
    lost_ = false;
  }
  if (why.empty() && hole.retract > hole.clearance) AppendStraight(at_height(hole.retract), true, hole.place);
  at_ = at_height(hole.retract);
  base_ = frame_.ToBase(at_);
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
  if (!modes_.unit_stated && modes_.unit_taken == 0) modes_.unit_taken = word->place.line;
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
                       fmt::format("the program turns axis {0}, and toolpath.cam.rotary_axes does not "
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

// TURN=n is n revolutions more; LinuxCNC's P counts those begun.
std::optional<double> GcodeMotion::FullTurns(const GcodeMove& move) const {
  const GcodeWord* begun = move.turns_begun;
  if (move.turns && begun) throw InputError(begun->place, "P and TURN in one arc");
  if (move.turns) return value_of_(*move.turns);
  if (!begun) return std::nullopt;
  const double turns = value_of_(*begun);
  if (!(turns >= 1 && turns <= 1000 && turns == std::floor(turns)))
    throw InputError(begun->place, "P of an arc needs a whole number of revolutions from 1 to 1000");
  return turns - 1;
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
  if (move.pole)
    for (size_t i = 0; i < 3; ++i) {
      arc.centre[i] = (*move.pole)[static_cast<int>(i)];
      arc.absolute[i] = true;
    }
  if (move.radius) arc.radius = value_of_(*move.radius) * modes_.Unit();
  if (const auto turns = FullTurns(move)) arc.full_turns = *turns;
  arc.place = move.place;
  ++arcs_;
  return PointsOf(arc, options_.chord_tolerance);
}

void GcodeMotion::KeepNamedWays() {
  for (const size_t i : named_ways_) path_.points[i].fresh = false;
}

void GcodeMotion::Append(GcodePath way, bool rapid) {
  way.end = direction_;
  way.tip_programmed = tip_programmed_;
  way.rapid = rapid;
  way.feed = modes_.feed;
  way.inverse_time = std::exchange(modes_.inverse_time, 0);
  if (modes_.feed_mode == 93 && !way.rapid && way.inverse_time == 0)
    throw InputError(way.place, "under G93 each cut needs its F");
  const size_t first = path_.points.size();
  AppendWay(way, frame_, options_, path_);
  const bool named = std::exchange(named_, false), fresh = std::exchange(fresh_, false);
  path_.points[first].fresh = (fresh || named) && first > 0;
  if (named && !fresh) named_ways_.push_back(first);
  for (size_t i = first; i < path_.points.size(); ++i) sections_.Stamp(path_.points[i]);
  if (!rapid && first > 0 && !std::exchange(cut_in_offset_, true)) UseOffset(way.place);
}

}  // namespace millpose
