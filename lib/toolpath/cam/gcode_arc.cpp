// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/gcode_arc.hpp"

#include "toolpath/cam/arc.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;
constexpr double kMaxRadius = 1e6;  // mm

// The plane's first and second axis, and the one across.
std::array<int, 3> AxesOf(int plane) {
  return plane == 0 ? std::array{0, 1, 2} : plane == 1 ? std::array{2, 0, 1} : std::array{1, 2, 0};
}

Vector CentreGiven(const GcodeArc& arc) {
  const std::array<int, 3> axes = AxesOf(arc.plane);
  if (!arc.centre[axes[0]] && !arc.centre[axes[1]])
    throw InputError(arc.place, "an arc needs its centre (I, J, K) or its radius (R, CR)");
  // Across the plane some controls count a helix's rise for each turn with it.
  if (const int across = axes[2]; arc.centre[across] && !arc.absolute[across] && *arc.centre[across] != 0)
    throw InputError(arc.place,
                     fmt::format("{} of an arc across it is not read: the end and the turns (P, TURN) "
                                 "say how a helix rises",
                                 "IJK"[across]));
  Vector centre = arc.from;
  for (int k = 0; k < 2; ++k)
    if (const int i = axes[k]; arc.centre[i])
      centre[i] = *arc.centre[i] + (arc.absolute[i] ? 0 : arc.from[i]);
  return centre;
}

Vector CentreByRadius(const GcodeArc& arc, const Vector& axis) {
  const double radius = *arc.radius;
  Vector chord = arc.to - arc.from;
  chord -= axis.dot(chord) * axis;
  const double half = chord.norm() / 2;
  if (!(half > 1e-6)) throw InputError(arc.place, "an arc by its radius needs an end that is not its start");
  if (half > std::abs(radius) + std::max(0.01, 1e-4 * half))
    throw InputError(arc.place,
                     fmt::format("a radius of {:.6g} mm does not span the {:.6g} mm from start to end",
                                 std::abs(radius), 2 * half));
  const double height = std::sqrt(std::max(0.0, radius * radius - half * half));
  const Vector left = axis.cross(chord).normalized();  // where the centre of the shorter right-hand arc lies
  return arc.from + chord / 2 + (radius > 0 ? height : -height) * left;
}

}  // namespace

std::vector<Vector> PointsOf(const GcodeArc& arc, double tolerance) {
  Vector axis = Vector::Zero();
  axis[AxesOf(arc.plane)[2]] = arc.counter_clockwise ? 1 : -1;
  const Vector centre = arc.radius ? CentreByRadius(arc, axis) : CentreGiven(arc);
  const auto off = [&](const Vector& p) -> double {
    const Vector d = p - centre;
    return (d - axis.dot(d) * axis).norm();
  };
  const double start = off(arc.from), end = off(arc.to);
  if (!(std::max(start, end) <= kMaxRadius && start > 1e-9 && end > 1e-9))
    throw InputError(arc.place,
                     fmt::format("an arc's radius must be above 0 and at most {} mm, found {:.4g} mm",
                                 kMaxRadius, std::max(start, end)));
  if (std::abs(start - end) > std::max(0.1, 1e-3 * start))
    throw InputError(arc.place,
                     fmt::format("the arc's ends lie {:.4g} mm and {:.4g} mm from its centre", start, end));
  if (!(arc.full_turns >= 0 && arc.full_turns <= 1000 && arc.full_turns == std::floor(arc.full_turns)))
    throw InputError(arc.place, "TURN needs a whole number from 0 to 1000");
  return ArcPoints(arc.from, arc.to, centre, axis, static_cast<int>(arc.full_turns), tolerance, arc.place);
}

}  // namespace millpose
