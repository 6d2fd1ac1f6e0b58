// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/apt_circle.hpp"

#include "toolpath/arc.hpp"

namespace millpose {
namespace {

constexpr double kMaxRadius = 1e6;  // mm: bounds the number of points that a circle becomes
constexpr double kOffCircle = 0.1;  // mm: files are written with three digits and tolerances below this

Eigen::Vector3d Across(const Eigen::Vector3d& vector, const Eigen::Vector3d& axis) {
  return vector - axis.dot(vector) * axis;
}

void CheckRadius(const AptCircle& circle, const Eigen::Vector3d& axis, const Eigen::Vector3d& from,
                 const Eigen::Vector3d& to) {
  const double start = Across(from - circle.centre, axis).norm();
  const double end = Across(to - circle.centre, axis).norm();
  const double radius = circle.radius.value_or(start);
  if (!(std::max({radius, start, end}) <= kMaxRadius))
    throw InputError(circle.place, fmt::format("the circle's radius of {:.4g} mm is above {} mm",
                                               std::max({radius, start, end}), kMaxRadius));
  const double off = std::max(std::abs(start - radius), std::abs(end - radius));
  if (off > std::max(kOffCircle, 1e-3 * radius))
    throw InputError(
        circle.place,
        fmt::format("the points before and after the circle lie {:.4g} mm and {:.4g} mm from its "
                    "axis, its radius is {:.4g} mm",
                    start, end, radius));
}

// Whether the right-hand turn about the axis is meant.
bool TurnsRight(const AptCircle& circle, const Eigen::Vector3d& axis, const Eigen::Vector3d& from,
                const Eigen::Vector3d& to, const Eigen::Vector3d& arriving) {
  constexpr double kClear = 1e-3;  // rad or cosine: less decides nothing
  if (circle.clockwise) return false;
  const Eigen::Vector3d a = Across(from - circle.centre, axis), b = Across(to - circle.centre, axis);
  const Eigen::Vector3d tangent = axis.cross(a).normalized();  // of the right-hand turn
  if (circle.tangent && std::abs(tangent.dot(*circle.tangent)) > 0.5) return tangent.dot(*circle.tangent) > 0;
  const double sine = axis.dot(a.cross(b)) / (a.norm() * b.norm());
  if (std::abs(sine) > kClear) return sine > 0;  // the shorter way
  const double along = arriving.norm() > 0 ? tangent.dot(arriving.normalized()) : 0;
  if (std::abs(along) > 0.5) return along > 0;
  throw InputError(
      circle.place,
      "half a turn or a full one, and neither INDIRV nor the motion before tells which way round");
}

}  // namespace

std::vector<Eigen::Vector3d> CirclePoints(const AptCircle& circle, const Eigen::Vector3d& from,
                                          const Eigen::Vector3d& to, const Eigen::Vector3d& arriving,
                                          double tolerance) {
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
    return {to};
  if (!TurnsRight(circle, axis, from, to, arriving)) axis = -axis;
  return ArcPoints(from, to, circle.centre, axis, circle.full_turns, tolerance, circle.place);
}

}  // namespace millpose
