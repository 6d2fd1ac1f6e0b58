// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/toolpath/path_check.hpp"

#include <cmath>

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;
using Kind = Want::Kind;

class Comparison {
 public:
  Comparison(const CamPath& path, double tolerance, double chord)
      : points_(path.points), tolerance_(tolerance), chord_(chord) {}

  std::string Run(const std::vector<Want>& wants) {
    for (size_t k = 0; k < wants.size() && error_.empty(); ++k) {
      Follow(wants[k]);
      if (!error_.empty()) error_ = fmt::format("motion {}: {}", k, error_);
    }
    if (error_.empty() && at_ < points_.size())
      error_ = fmt::format("{} points more than meant, the first in line {}", points_.size() - at_,
                           points_[at_].line);
    return error_;
  }

 private:
  bool Near(const Vector& a, const Vector& b) const { return (a - b).norm() <= tolerance_; }

  void Fail(const std::string& what) {
    if (!error_.empty()) return;
    error_ = what;
    if (at_ < points_.size())
      error_ += fmt::format(" (line {}: {:.6f} {:.6f} {:.6f}{})", points_[at_].line,
                            points_[at_].position.x(), points_[at_].position.y(), points_[at_].position.z(),
                            points_[at_].rapid ? ", rapid" : "");
  }

  void Follow(const Want& want) {
    double swept = 0;
    size_t sample = 0;
    for (Vector before = last_;; ++at_) {
      if (at_ >= points_.size()) return Fail("the path ends too early");
      const CamPoint& point = points_[at_];
      if (point.rapid != (want.kind == Kind::kRapid)) return Fail("rapid or not");
      if (want.feed >= 0 && !(std::abs(point.feed_rate - want.feed) <= 1e-9 * (1 + want.feed)))
        return Fail(fmt::format("feed {} in place of {}", point.feed_rate, want.feed));
      if (want.kind == Kind::kArc) swept += TurnOf(want, before, point.position);
      if (want.kind == Kind::kCurve) sample = OnCurve(want, sample, before, point.position);
      const bool there = Near(point.position, want.to) && std::abs(swept - want.angle) < 1e-5;
      if (!there) Between(want, point.position, swept);
      if (!error_.empty()) return;
      before = point.position;
      if (!there) continue;
      if (!((point.axis - want.axis).norm() <= std::max(tolerance_, 1e-9)))
        Fail(fmt::format("axis {} {} {} in place of {} {} {}", point.axis.x(), point.axis.y(), point.axis.z(),
                         want.axis.x(), want.axis.y(), want.axis.z()));
      last_ = want.to;
      ++at_;
      return;
    }
  }

  // A point before the end.
  void Between(const Want& want, const Vector& p, double swept) {
    if (want.kind == Kind::kRapid) return Fail("rapid to elsewhere");
    if (want.kind == Kind::kStraight) {
      const Vector way = want.to - last_;
      const double share = way.squaredNorm() > 0 ? (p - last_).dot(way) / way.squaredNorm() : 0;
      if (share < -1e-9 || share > 1 + 1e-9 || !Near(p, last_ + share * way)) Fail("off the straight way");
    }
    if (want.kind == Kind::kArc) {
      const double a = Radius(want, last_), b = Radius(want, want.to), r = Radius(want, p);
      const double rise = want.about.dot(want.to - last_), share = swept / want.angle;
      if (r < std::min(a, b) - tolerance_ || r > std::max(a, b) + tolerance_) return Fail("off the arc");
      if (share > 1 + 1e-6 ||
          std::abs(want.about.dot(p - last_) - share * rise) > tolerance_ + 1e-6 * std::abs(rise))
        Fail("off the helix");
    }
  }

  static Vector Across(const Want& want, const Vector& p) {
    const Vector d = p - want.centre;
    return d - want.about.dot(d) * want.about;
  }
  static double Radius(const Want& want, const Vector& p) { return Across(want, p).norm(); }

  double TurnOf(const Want& want, const Vector& from, const Vector& to) {
    const Vector a = Across(want, from), b = Across(want, to);
    const double angle = std::atan2(want.about.dot(a.cross(b)), a.dot(b));
    if (angle < -1e-4) Fail("turns the wrong way");
    if (a.norm() * (1 - std::cos(angle / 2)) > chord_ * 1.01 + 1e-9) Fail("a chord too far from the arc");
    return angle;
  }

  // The sample at which the point lies; those that were passed over must lie near the chord.
  size_t OnCurve(const Want& want, size_t from, const Vector& before, const Vector& p) {
    for (size_t k = from; k < want.curve.size(); ++k) {
      const Vector& sample = want.curve[k];
      if (Near(sample, p)) return k;
      const Vector way = p - before;
      const double share =
          way.squaredNorm() > 0 ? std::clamp((sample - before).dot(way) / way.squaredNorm(), 0.0, 1.0) : 0;
      if ((sample - before - share * way).norm() > chord_ * 1.01 + 1e-9) {
        Fail("a chord too far from the curve, or a point off it");
        return k;
      }
    }
    Fail("a point that is not on the curve");
    return from;
  }

  const std::vector<CamPoint>& points_;
  double tolerance_, chord_;
  size_t at_ = 0;
  Vector last_ = Vector::Zero();
  std::string error_;
};

}  // namespace

std::string Difference(const CamPath& path, const std::vector<Want>& wants, double tolerance, double chord) {
  return Comparison(path, tolerance, chord).Run(wants);
}

}  // namespace millpose
