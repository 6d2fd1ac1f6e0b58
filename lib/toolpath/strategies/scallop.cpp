// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/scallop.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

// A place beside a contact as (way along the surface, height over it); the surface is a circle there.
Eigen::Vector2d Unrolled(const Eigen::Vector2d& p, double curvature) {
  if (std::abs(curvature) < 1e-9) return p;
  const double radius = 1 / curvature;  // negative where the surface is concave
  const Eigen::Vector2d d = std::copysign(1.0, radius) * (p + Eigen::Vector2d(0, radius));
  return {radius * Atan2(std::copysign(1.0, radius) * d.x(), d.y()),
          std::copysign(1.0, radius) * (d.norm() - std::abs(radius))};
}

}  // namespace

// The outline from the contact (place 0) over the end of a flat (1) to the cutter's side (2), on one side;
// coordinates along the surface and out of it, the contact at the origin.
Eigen::Vector2d Scallops::Outline(double place, double side) const {
  const double a = cutter_.radius - cutter_.corner_radius, b = a * SinCos(lead_).sin;
  const auto [s, c] = SinCos(tilt_);
  const auto support = [&](const Eigen::Vector2d& u) -> Eigen::Vector2d {
    const Eigen::Vector2d own(c * u.x() + s * u.y(), -s * u.x() + c * u.y());  // in the ellipse's axes
    const Eigen::Vector2d scaled(a * own.x(), b * own.y());
    if (!(scaled.norm() > 0)) return Eigen::Vector2d::Zero();
    const Eigen::Vector2d q(a * scaled.x() / scaled.norm(), b * scaled.y() / scaled.norm());
    return {c * q.x() - s * q.y(), s * q.x() + c * q.y()};
  };
  const Eigen::Vector2d down(0, -1);
  const Eigen::Vector2d contact = support(down) + cutter_.corner_radius * down;
  const double angle = std::max(0.0, place - 1) * kPi / 2;
  // Just off the vertical a flat's support is its end.
  const Eigen::Vector2d u(side * SinCos(std::max(angle, 1e-12)).sin, -SinCos(angle).cos);
  const Eigen::Vector2d p = support(u) + cutter_.corner_radius * u - contact;
  return place < 1 ? Eigen::Vector2d(place * p) : p;
}

// How far from the contact along the surface the outline has risen to a height.
double Scallops::Reach(double height, double curvature, double side) const {
  constexpr int kSteps = 64;
  double low = 0, high = 2;
  for (int i = 1; i <= kSteps; ++i) {
    const double place = 2.0 * i / kSteps;
    if (Unrolled(Outline(place, side), curvature).y() < height) {
      low = place;
    } else {
      high = place;
      break;
    }
  }
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (Unrolled(Outline(middle, side), curvature).y() < height ? low : high) = middle;
  }
  return std::abs(Unrolled(Outline(high, side), curvature).x());
}

double Scallops::Stepover(double height, double curvature) const {
  const double left = Reach(height, curvature, 1), right = Reach(height, curvature, -1);
  return back_and_forth_ ? 2 * std::min(left, right) : left + right;
}

}  // namespace millpose
