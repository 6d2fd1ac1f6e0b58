// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/ring_frame.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"
#include "geometry/mesh/triangle.hpp"

namespace millpose {

RingFrame::RingFrame(const Axis& axis, const Eigen::Vector3d& reference, bool left_handed)
    : axis_(axis), about_(left_handed ? -axis.direction : axis.direction) {
  const Eigen::Vector3d flat = reference - reference.dot(about_) * about_;
  zero_ = flat.norm() > 1e-6 ? Eigen::Vector3d(flat.normalized()) : axis_.direction.unitOrthogonal();
  quarter_ = about_.cross(zero_);
}

Eigen::Vector3d RingFrame::Radial(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d d = p - axis_.point;
  return d - d.dot(about_) * about_;
}

double RingFrame::Angle(const Eigen::Vector3d& p, double seam) const {
  const Eigen::Vector3d d = p - axis_.point;
  const double angle = Atan2(d.dot(quarter_), d.dot(zero_)) - seam;
  return angle - 2 * kPi * std::floor(angle / (2 * kPi));
}

// 0 where the axis passes through the polygon, else on a side.
double RingFrame::LeastRadius(const std::vector<Eigen::Vector3d>& polygon) const {
  double least = std::numeric_limits<double>::infinity();
  bool left = true, right = true;  // the axis lies on one side of all sides
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d a = Radial(polygon[i]), b = Radial(polygon[(i + 1) % polygon.size()]);
    const double t = ClosestOnSegment(Eigen::Vector3d::Zero(), a, b);
    least = std::min(least, (a + t * (b - a)).norm());
    const double side = about_.dot(a.cross(b));
    left = left && side > 0;
    right = right && side < 0;
  }
  return left || right ? 0.0 : least;
}

Curve RingFrame::Turned(const Curve& curve) const {
  double turning = 0;
  for (const CurvePiece& piece : curve.pieces)
    turning += about_.dot(Radial(piece.start).cross(piece.end - piece.start));
  return turning < 0 ? Reversed(curve) : curve;
}

std::optional<double> RingFrame::SeamOn(const CurvePiece& piece, double seam) const {
  const SineCosine turn = SinCos(std::remainder(seam, 2 * kPi));
  const Eigen::Vector3d out = turn.cos * zero_ + turn.sin * quarter_;
  const Eigen::Vector3d side = about_.cross(out);
  const auto beyond = [&](double t) { return side.dot(piece.At(t) - axis_.point) >= 0; };
  if (beyond(0) || !beyond(1) || out.dot(piece.start - axis_.point) <= 0) return std::nullopt;
  double low = 0, high = 1;
  for (int i = 0; i < 50; ++i) {
    const double middle = (low + high) / 2;
    (beyond(middle) ? high : low) = middle;
  }
  return high;
}

void RingFrame::MoveSeam(Curve& curve, double seam) const {
  for (size_t i = 0; curve.closed && i < curve.pieces.size(); ++i) {
    const std::optional<double> at = SeamOn(curve.pieces[i], seam);
    if (!at) continue;
    std::rotate(curve.pieces.begin(), curve.pieces.begin() + static_cast<std::ptrdiff_t>(i),
                curve.pieces.end());
    const CurvePiece whole = curve.pieces.front();
    if (*at > 1 - 1e-9) {
      std::rotate(curve.pieces.begin(), curve.pieces.begin() + 1, curve.pieces.end());
    } else {
      curve.pieces.front() = whole.Part(*at, 1);
      curve.pieces.push_back(whole.Part(0, *at));
    }
    return;
  }
}

}  // namespace millpose
