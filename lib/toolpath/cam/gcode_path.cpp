// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/gcode_path.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;
constexpr size_t kMaxPoints = 2'000'000;   // bounds what arcs of a small file can become
constexpr double kTurnStep = DegToRad(3);  // of rotary axes between two points of a cut

Vector AxisAt(const GcodePath& way, double share, const std::array<double, 3>& angles,
              const RotaryAxes& axes) {
  if (share == 1) return way.end.axis;
  if (!way.end.by_vector) return axes.ToolAxis(angles);
  const Vector axis = way.start.axis + share * (way.end.axis - way.start.axis);
  return axis.norm() > 1e-6 ? Vector(axis.normalized()) : way.end.axis;
}

// How many points each chord becomes.
size_t Refinement(const GcodePath& way, const GcodeFrame& frame, const CamReadOptions& options) {
  if (way.end.by_vector || way.rapid || !way.cut_from_known) return 1;
  double turn = 0;
  for (size_t k = 0; k < 3; ++k) turn = std::max(turn, std::abs(way.end.angles[k] - way.start.angles[k]));
  if (turn == 0) return 1;
  double step = kTurnStep;
  if (!way.tip_programmed) {
    const double lever = std::max(options.rotary_axes.Lever(frame.ToBase(way.points.back())), 1.0);
    const double cosine = std::max(0.5, 1 - options.chord_tolerance / lever);
    step = std::min(step, 2 * Atan2(std::sqrt(1 - cosine * cosine), cosine));
  }
  const auto wanted = static_cast<size_t>(std::ceil(turn / step - 1e-9));
  return std::max<size_t>(1, (wanted + way.points.size() - 1) / way.points.size());
}

std::vector<Vector> Refined(const GcodePath& way, size_t each) {
  std::vector<Vector> fine;
  Vector from = way.from;
  for (const Vector& to : way.points) {
    for (size_t k = 1; k <= each; ++k)
      fine.push_back(
          k == each ? to : Vector(from + static_cast<double>(k) / static_cast<double>(each) * (to - from)));
    from = to;
  }
  return fine;
}

}  // namespace

void AppendWay(const GcodePath& way, const GcodeFrame& frame, const CamReadOptions& options, CamPath& path) {
  const size_t each = Refinement(way, frame, options), first = path.points.size();
  if (first + each * way.points.size() > kMaxPoints)
    throw InputError(way.place, fmt::format("the path has more than {} points", kMaxPoints));
  const std::vector<Vector> points = Refined(way, each);
  double length = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const double share = static_cast<double>(i + 1) / static_cast<double>(points.size());
    std::array<double, 3> angles{};
    for (size_t k = 0; k < 3; ++k)
      angles[k] = way.start.angles[k] + share * (way.end.angles[k] - way.start.angles[k]);
    const Vector base = frame.ToBase(points[i]);
    CamPoint point;
    point.position = way.tip_programmed ? base : options.rotary_axes.Tip(base, angles);
    point.axis = AxisAt(way, share, angles, options.rotary_axes);
    point.feed_rate = way.feed;
    point.rapid = way.rapid;
    point.line = way.place.line;
    if (!path.points.empty()) length += (point.position - path.points.back().position).norm();
    path.points.push_back(point);
  }
  if (way.inverse_time > 0)
    for (size_t i = first; i < path.points.size(); ++i) path.points[i].feed_rate = length * way.inverse_time;
}

}  // namespace millpose
