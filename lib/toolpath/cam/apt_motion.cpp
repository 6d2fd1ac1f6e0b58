// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/apt_motion.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;
constexpr size_t kMaxAptPoints = 2'000'000;  // bounds what circles of a small file can become

}  // namespace

void AptSystem::TakeUnits(const AptStatement& statement) {
  const std::string name = statement.minors.empty() ? "" : statement.minors[0].text;
  if (name == "MM") {
    unit = 1;
  } else if (name == "INCHES" || name == "INCH" || name == "IN") {
    unit = 25.4;
  } else if (name == "CM") {
    unit = 10;
  } else {
    throw InputError(statement.major.place,
                     fmt::format("UNITS needs MM, CM or INCHES, found \"{}\"", name.substr(0, 40)));
  }
}

void AptSystem::TakeMsys(const AptStatement& statement) {
  const std::vector<double> v = Numbers(statement, 9, 9);
  const Vector x(v[3], v[4], v[5]), y(v[6], v[7], v[8]), z = x.cross(y);
  if (!(z.norm() > 1e-6)) throw InputError(statement.major.place, "the axes of MSYS do not span a plane");
  origin = unit * Vector(v[0], v[1], v[2]);
  rotation.col(0) = x.normalized();
  rotation.col(2) = z.normalized();
  rotation.col(1) = rotation.col(2).cross(rotation.col(0));
}

void AptSystem::TakeFrame(const AptFrame& frame) {
  origin = unit * frame.origin;
  rotation = frame.rotation;
}

Vector AptSystem::Direction(const std::vector<double>& v, size_t first, const AptStatement& statement) const {
  const Vector direction(v[first], v[first + 1], v[first + 2]);
  if (!(direction.norm() > 1e-6 && direction.norm() < 1e6))
    throw InputError(statement.minors[first].place, "the direction has no length");
  return (rotation * direction).normalized();
}

void AptMotion::SetFresh() {
  fresh_ = true;
  arriving_.setZero();
}

void AptMotion::SetCircle(const AptCircle& circle) {
  if (!HasPoint()) throw InputError(circle.place, "the circle needs a point before it");
  if (cycle_) throw InputError(circle.place, "a CIRCLE within a CYCLE");
  circle_ = circle;
}

void AptMotion::SetCycle(std::optional<AptCycle> cycle) {
  cycle_ = std::move(cycle);
  before_cycle_ = at_;
}

void AptMotion::CheckEnd() const {
  if (circle_) throw InputError(circle_->place, "a CIRCLE is not followed by the GOTO that it leads to");
}

void AptMotion::MoveTo(const Vector& to, const Vector& axis, const SourceLocation& place) {
  const Vector before = axis_;
  axis_ = axis;
  if (cycle_) return Drill(to, place);
  std::vector<Vector> way{to};
  Vector leaving = to - at_;
  if (circle_ && !rapid_) {
    circle_->tangent = tangent_;
    AptArc arc = FollowCircle(*circle_, at_, to, arriving_, options_.circle, options_.chord_tolerance);
    way = std::move(arc.points);
    leaving = arc.leaving;
    ++circles_;
  }
  const bool cut = HasPoint() && !rapid_ && !fresh_;
  circle_.reset();
  tangent_.reset();
  Append(way, before, place);
  arriving_ = cut ? leaving : Vector(Vector::Zero());
}

void AptMotion::Follow(const AptNurbs& nurbs, const std::vector<Vector>& control) {
  constexpr double kOff = 0.1;  // mm: files are written with three digits
  if (cycle_ || circle_) throw InputError(nurbs.place(), "a NURBS behind a CIRCLE or within a CYCLE");
  const Vector start = nurbs.Start(control);
  if (!HasPoint() || rapid_ || fresh_) {
    Append({start}, axis_, nurbs.place());
  } else if (!((start - at_).norm() <= kOff)) {
    throw InputError(nurbs.place(),
                     fmt::format("the NURBS begins {:.4g} mm from where the tool is", (start - at_).norm()));
  }
  const std::vector<Vector> way = nurbs.Points(control, options_.chord_tolerance);
  const Vector before = way.size() > 1 ? way[way.size() - 2] : at_;
  tangent_.reset();
  Append(way, axis_, nurbs.place());
  arriving_ = at_ - before;
  ++splines_;
}

void AptMotion::Append(const std::vector<Vector>& way, const Vector& axis_before,
                       const SourceLocation& place) {
  for (size_t i = 0; i < way.size(); ++i) {
    const double share = static_cast<double>(i + 1) / static_cast<double>(way.size());
    const Vector between = axis_before + share * (axis_ - axis_before);
    AddPoint(way[i], i + 1 < way.size() && between.norm() > 1e-6 ? Vector(between.normalized()) : axis_,
             rapid_, place);
  }
  rapid_ = false;  // RAPID holds for the next motion only
}

void AptMotion::AddPoint(const Vector& position, const Vector& axis, bool rapid,
                         const SourceLocation& place) {
  if (path_.points.size() >= kMaxAptPoints)
    throw InputError({place.file, place.line},
                     fmt::format("the path has more than {} points", kMaxAptPoints));
  path_.points.push_back({position, axis, feed_, rapid, fresh_ && HasPoint(), place.line});
  sections_.Stamp(path_.points.back());
  fresh_ = false;
  at_ = position;
}

// The cycle with its heights from `point` on. Of one by places the point is the hole's top or its bottom; the
// latter can only be where the tool stood at the clearance's height before the cycle, above the hole's top.
AptCycle AptMotion::CycleAt(const Vector& point) {
  AptCycle cycle = *cycle_;
  if (!cycle.by_place || !rules_.cycle_point_asked) return cycle;
  constexpr double kSame = 1e-3;  // mm
  const double height = axis_.dot(point), top = height + *cycle.by_place;
  const bool may_be_bottom =
      std::abs(axis_.dot(before_cycle_) - cycle.clearance) <= kSame && cycle.clearance > top - kSame;
  if (options_.cycle_point) path_.keys_used.insert("cycle_point");
  if (options_.cycle_point == CyclePoint::kBottom) return FromBottom(cycle, height);
  if (may_be_bottom && !options_.cycle_point)
    throw InputError(
        cycle.place,
        fmt::format("{} by places: the point of a hole may be its top (the hole ends at {:.6g} mm along the "
                    "axis) or its bottom (it ends at {:.6g} mm, and {:.6g} mm is the clearance's height, as "
                    "Autodesk's post writes it): state toolpath.cam.cycle_point: top or bottom",
                    cycle.name, height - *cycle.by_place, height, cycle.clearance));
  return cycle;
}

// A rapid to the clearance, straight strokes at the cycle's feed, a rapid to where the tool is drawn back.
void AptMotion::Drill(const Vector& point, const SourceLocation& place) {
  rapid_ = false;
  arriving_.setZero();
  if (!cycle_->left_out.empty()) {
    path_.holes_left_out.push_back({point, cycle_->name, cycle_->left_out, place.line});
    sections_.Stamp(path_.holes_left_out.back());
    fresh_ = true;
    return;
  }
  const AptCycle cycle = CycleAt(point);
  const double feed = std::exchange(feed_, cycle.feed);
  AddPoint(point + cycle.clearance * axis_, axis_, true, place);
  for (const double height : cycle.strokes) AddPoint(point + height * axis_, axis_, false, place);
  if (cycle.retract > cycle.clearance) AddPoint(point + cycle.retract * axis_, axis_, true, place);
  feed_ = feed;
  ++holes_;
}

}  // namespace millpose
