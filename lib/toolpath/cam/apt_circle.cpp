// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/apt_circle.hpp"

#include "base/units.hpp"
#include "toolpath/cam/arc.hpp"

namespace millpose {
namespace {

constexpr double kMaxCircle = 1e6;  // mm: bounds the number of points that a circle becomes
constexpr double kOffCircle = 0.1;  // mm: files are written with three digits and tolerances below this

void CheckRadius(const AptCircle& circle, const Eigen::Vector3d& axis, const Eigen::Vector3d& from,
                 const Eigen::Vector3d& to) {
  const double start = Across(from - circle.centre, axis).norm();
  const double end = Across(to - circle.centre, axis).norm();
  const double radius = circle.radius.value_or(start);
  if (!(std::max({radius, start, end}) <= kMaxCircle))
    throw InputError(circle.place, fmt::format("the circle's radius of {:.4g} mm is above {} mm",
                                               std::max({radius, start, end}), kMaxCircle));
  const double off = std::max(std::abs(start - radius), std::abs(end - radius));
  if (off > std::max(kOffCircle, 1e-3 * radius))
    throw InputError(
        circle.place,
        fmt::format("the points before and after the circle lie {:.4g} mm and {:.4g} mm from its "
                    "axis, its radius is {:.4g} mm",
                    start, end, radius));
}

// The direction of motion at the start (or end) of the right-hand turn about the axis; any length.
Eigen::Vector3d Tangent(const AptCircle& circle, const Eigen::Vector3d& axis, const Eigen::Vector3d& from,
                        const Eigen::Vector3d& to, bool at_end) {
  const double angle = ArcAngle(from, to, circle.centre, axis, circle.full_turns);
  const Eigen::Vector3d round = axis.cross(Across((at_end ? to : from) - circle.centre, axis));
  return angle * round + axis.dot(to - from) * axis;
}

// Where the cut before runs on into one of the two turns: whether that is the right-hand one about the axis.
std::optional<bool> RunsOnRight(const AptCircle& circle, const Eigen::Vector3d& axis,
                                const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                const Eigen::Vector3d& arriving) {
  constexpr double kWithin = 0.99619469809174555;  // cosine of 5 degrees
  if (!(arriving.norm() > 0)) return std::nullopt;
  const auto goes_on = [&](const Eigen::Vector3d& about) {
    return arriving.normalized().dot(Tangent(circle, about, from, to, false).normalized()) >= kWithin;
  };
  const bool right = goes_on(axis), left = goes_on(-axis);
  return right == left ? std::nullopt : std::optional(right);  // a steep helix may look like both
}

// Half a turn or a full one: their two ways differ by nothing but the direction.
bool IsHalfOrFull(const AptCircle& circle, const Eigen::Vector3d& axis, const Eigen::Vector3d& from,
                  const Eigen::Vector3d& to) {
  constexpr double kHalf = 1e-3;       // rad
  constexpr double kSamePoint = 1e-4;  // mm
  const Eigen::Vector3d a = Across(from - circle.centre, axis), b = Across(to - circle.centre, axis);
  const double sine = axis.dot(a.cross(b)) / (a.norm() * b.norm());
  return (a - b).norm() <= kSamePoint || (std::abs(sine) <= kHalf && a.dot(b) < 0);
}

// Whether the right-hand turn about the axis is meant.
bool TurnsRight(const AptCircle& circle, const Eigen::Vector3d& axis, const Eigen::Vector3d& from,
                const Eigen::Vector3d& to, const Eigen::Vector3d& arriving, CircleSense way) {
  const Eigen::Vector3d tangent = axis.cross(Across(from - circle.centre, axis)).normalized();
  if (circle.tangent && std::abs(tangent.dot(*circle.tangent)) > 0.5) return tangent.dot(*circle.tangent) > 0;
  const bool by_sign = !circle.clockwise;
  if (way == CircleSense::kAxis || IsHalfOrFull(circle, axis, from, to)) return by_sign;
  const std::optional<bool> runs_on = RunsOnRight(circle, axis, from, to, arriving);
  if (!runs_on || *runs_on == by_sign) return by_sign;
  if (way == CircleSense::kTangent) return *runs_on;
  throw InputError(
      circle.place,
      fmt::format("the cut before runs on into the {} turn about the circle's axis, the axis's sign says {}: "
                  "state toolpath.cam.circle: tangent or axis, whichever holds in this file",
                  *runs_on ? "counter-clockwise" : "clockwise", by_sign ? "counter-clockwise" : "clockwise"));
}

// The revolutions that a stated sweep has besides the part from start to end. Throws InputError when it ends
// elsewhere.
int TurnsOf(const AptCircle& circle, const Eigen::Vector3d& axis, const Eigen::Vector3d& from,
            const Eigen::Vector3d& to) {
  const double part = ArcAngle(from, to, circle.centre, axis, 0);
  const double turns = std::round((*circle.sweep - part) / (2 * kPi));
  const double radius = Across(from - circle.centre, axis).norm();
  const double off = std::abs(*circle.sweep - part - 2 * kPi * turns) * radius;
  if (!(turns >= 0 && turns <= 1000) || off > std::max(kOffCircle, 1e-3 * radius))
    throw InputError(circle.place,
                     fmt::format("the arc sweeps {:.6g}°, the point that it leads to lies {:.6g}° "
                                 "round (right-handed about its axis)",
                                 RadToDeg(*circle.sweep), RadToDeg(part)));
  return static_cast<int>(turns);
}

}  // namespace

AptArc FollowCircle(const AptCircle& circle, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                    const Eigen::Vector3d& arriving, CircleSense way, double tolerance) {
  Eigen::Vector3d axis;
  if (circle.axis) {
    axis = *circle.axis;
  } else {
    const Eigen::Vector3d normal =
        circle.tangent ? Eigen::Vector3d((from - circle.centre).cross(*circle.tangent)) : from;
    if (!circle.tangent || !(normal.norm() > 1e-3 * (from - circle.centre).norm()))
      throw InputError(circle.place, "the circle needs an INDIRV before it that is not radial");
    axis = normal.normalized();
  }
  CheckRadius(circle, axis, from, to);
  if (Across(from - circle.centre, axis).norm() < 1e-9 || Across(to - circle.centre, axis).norm() < 1e-9)
    return {{to}, to - from};
  AptCircle turned = circle;
  if (circle.sweep)
    turned.full_turns = TurnsOf(circle, axis, from, to);
  else if (!TurnsRight(circle, axis, from, to, arriving, way))
    axis = -axis;
  return {ArcPoints(from, to, circle.centre, axis, turned.full_turns, tolerance, circle.place),
          Tangent(turned, axis, from, to, true)};
}

}  // namespace millpose
