// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/scallop.hpp"

#include <array>

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

// The other way.
Eigen::Vector2d Rolled(const Eigen::Vector2d& p, double curvature) {
  if (std::abs(curvature) < 1e-9) return p;
  const double radius = 1 / curvature;
  const auto turn = SinCos(p.x() / radius);
  return {(radius + p.y()) * turn.sin, (radius + p.y()) * turn.cos - radius};
}

}  // namespace

// The outline from the contact (place 0) over the end of a flat (1) to the cutter's side (2), on one side;
// coordinates along the surface and out of it, the contact at the origin.
Eigen::Vector2d Scallops::Outline(double place, double side) const {
  const double a = cutter_.radius - cutter_.corner_radius, b = a * SinCos(lead_).sin;
  const auto turn = SinCos(tilt_);
  const double s = turn.sin, c = turn.cos;
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

std::pair<double, double> Scallops::Reaches(double height, double curvature) const {
  const double left = Reach(height, curvature, 1), right = Reach(height, curvature, -1);
  const double less = std::min(left, right);
  return back_and_forth_ ? std::pair(less, less) : std::pair(left, right);
}

bool Scallops::Covers(double height, double curvature, double left, double right) const {
  constexpr double kSlack = 1 - 1e-7;  // of the ways: rounding
  return CoversSide(Rolled({kSlack * left, height}, curvature), 1) &&
         CoversSide(Rolled({-kSlack * right, height}, curvature), -1);
}

// Whether a place lies within the outline and all that is above it: no direction from straight down to
// sideways sees it beyond. As the direction turns, how far it is beyond rises to one greatest value and falls
// again.
bool Scallops::CoversSide(const Eigen::Vector2d& place, double side) const {
  constexpr double kRounding = 1e-9;  // mm
  constexpr int kDirections = 16, kSections = 32;
  const double r = cutter_.corner_radius, a = cutter_.radius - r, b = a * SinCos(lead_).sin;
  const auto [s, c] = SinCos(tilt_);
  Eigen::Vector2d contact(0, -r);  // from the ellipse's centre: its support straight down
  if (const double n = std::sqrt(a * a * s * s + b * b * c * c); n > 0) {
    const double x = -a * a * s / n, y = -b * b * c / n;
    contact += Eigen::Vector2d(c * x - s * y, s * x + c * y);
  }
  const auto beyond = [&, s = s, c = c](double angle) {
    const auto turn = SinCos(angle);
    const Eigen::Vector2d u(side * turn.sin, -turn.cos);
    const double x = c * u.x() + s * u.y(), y = -s * u.x() + c * u.y();
    return u.dot(place + contact) - std::sqrt(a * a * x * x + b * b * y * y) - r;
  };
  int best = 0;
  std::array<double, kDirections + 1> values;
  for (int i = 0; i <= kDirections; ++i) {
    values[static_cast<size_t>(i)] = beyond(kPi / 2 * i / kDirections);
    if (values[static_cast<size_t>(i)] > values[static_cast<size_t>(best)]) best = i;
  }
  double low = kPi / 2 * std::max(0, best - 1) / kDirections;
  double high = kPi / 2 * std::min(kDirections, best + 1) / kDirections;
  for (int i = 0; i < kSections; ++i) {
    const double first = low + (high - low) / 3, second = high - (high - low) / 3;
    const double at_first = beyond(first), at_second = beyond(second);
    if (std::max(at_first, at_second) > kRounding) return false;
    (at_first < at_second ? low : high) = at_first < at_second ? first : second;
  }
  return values[static_cast<size_t>(best)] <= kRounding;
}

}  // namespace millpose
