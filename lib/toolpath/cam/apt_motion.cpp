// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/apt_motion.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;
constexpr size_t kMaxPoints = 2'000'000;  // bounds what circles of a small file can become

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

void AptMotion::CheckEnd() const {
  if (circle_) throw InputError(circle_->place, "a CIRCLE is not followed by the GOTO that it leads to");
}

void AptMotion::MoveTo(const Vector& to, const Vector& axis, const Place& place) {
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

void AptMotion::Append(const std::vector<Vector>& way, const Vector& axis_before, const Place& place) {
  for (size_t i = 0; i < way.size(); ++i) {
    const double share = static_cast<double>(i + 1) / static_cast<double>(way.size());
    const Vector between = axis_before + share * (axis_ - axis_before);
    AddPoint(way[i], i + 1 < way.size() && between.norm() > 1e-6 ? Vector(between.normalized()) : axis_,
             rapid_, place);
  }
  rapid_ = false;  // RAPID holds for the next motion only
}

void AptMotion::AddPoint(const Vector& position, const Vector& axis, bool rapid, const Place& place) {
  if (path_.points.size() >= kMaxPoints)
    throw InputError({place.file, place.line}, fmt::format("the path has more than {} points", kMaxPoints));
  path_.points.push_back({position, axis, feed_, rapid, fresh_ && HasPoint(), place.line});
  fresh_ = false;
  at_ = position;
}

// A rapid to the clearance, straight strokes at the cycle's feed, a rapid to where the tool is drawn back.
void AptMotion::Drill(const Vector& top, const Place& place) {
  rapid_ = false;
  arriving_.setZero();
  if (!cycle_->left_out.empty()) {
    path_.holes_left_out.push_back({top, cycle_->name, cycle_->left_out, place.line});
    fresh_ = true;
    return;
  }
  const double feed = std::exchange(feed_, cycle_->feed);
  AddPoint(top + cycle_->clearance * axis_, axis_, true, place);
  for (const double height : cycle_->strokes) AddPoint(top + height * axis_, axis_, false, place);
  if (cycle_->retract > cycle_->clearance) AddPoint(top + cycle_->retract * axis_, axis_, true, place);
  feed_ = feed;
  ++holes_;
}

}  // namespace millpose
