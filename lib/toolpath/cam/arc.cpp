// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/arc.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
double ArcAngle(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& centre,
                const Eigen::Vector3d& axis, int full_turns) {
  const Eigen::Vector3d a = Across(from - centre, axis), b = Across(to - centre, axis);
  double angle = Atan2(axis.dot(a.cross(b)), a.dot(b));
  // Ends that coincide within rounding of the file (1e-4 mm) are a full revolution.
  if (angle <= 1e-4 / a.norm()) angle += 2 * kPi;
  return angle + 2 * kPi * full_turns;
}

std::vector<Eigen::Vector3d> ArcPoints(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                       const Eigen::Vector3d& centre, const Eigen::Vector3d& axis,
                                       int full_turns, double tolerance, const SourceLocation& place) {
  const Eigen::Vector3d a = Across(from - centre, axis), b = Across(to - centre, axis);
  const double radius = a.norm(), end_radius = b.norm();
  if (radius < 1e-9 || end_radius < 1e-9) return {to};
  const double angle = ArcAngle(from, to, centre, axis, full_turns);
  const double cosine = std::max(0.5, 1 - tolerance / std::max(radius, end_radius));
  const double step = 2 * Atan2(std::sqrt(1 - cosine * cosine), cosine);
  constexpr double kMost = 1e6;  // bounds the memory that a short line can ask for
  if (!(angle / step <= kMost))
    throw InputError(
        place, fmt::format("an arc of more than {} points: is the chord tolerance of {} mm meant?", kMost,
                           tolerance));
  const int count = std::max(1, static_cast<int>(std::ceil(angle / step)));
  const Eigen::Vector3d u = a / radius, v = axis.cross(u);
  const double low = axis.dot(from - centre), high = axis.dot(to - centre);
  std::vector<Eigen::Vector3d> points;
  for (int k = 1; k < count; ++k) {
    const double share = static_cast<double>(k) / count, turned = share * angle;
    const SineCosine turn = SinCos(turned);
    points.push_back(centre + (radius + share * (end_radius - radius)) * (turn.cos * u + turn.sin * v) +
                     (low + share * (high - low)) * axis);
  }
  points.push_back(to);
  return points;
}

}  // namespace millpose
