// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/rough_entry.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kWidest = 0.8, kTightest = 0.3;  // radius of a helix, in the disc's
constexpr int kRampDirections = 24;

Vector3d AtHeight(const Vector2d& place, double height) { return {place.x(), place.y(), height}; }

double SlopeOf(double angle) {
  const SineCosine turn = SinCos(angle);
  return turn.sin / turn.cos;
}

std::vector<Vector3d> Helix(const RoughLayerOptions& options, const Vector2d& middle, double radius,
                            double top) {
  const double chord = std::min(options.chord, radius / 4);
  const auto sides = static_cast<int>(std::clamp(std::ceil(kPi / std::sqrt(2 * chord / radius)), 8.0, 72.0));
  const double per_turn = sides * 2 * radius * SinCos(kPi / sides).sin * SlopeOf(options.ramp);
  const auto turns = static_cast<int>(std::ceil((top - options.floor) / per_turn));
  const double sign = options.march.climb ? 1 : -1;
  std::vector<Vector3d> way;
  for (int i = 0; i <= (turns + 1) * sides; ++i) {
    const SineCosine turn = SinCos(sign * 2 * kPi * (i % sides) / sides);
    const double down = std::min(1.0, static_cast<double>(i) / std::max(1, turns * sides));
    way.push_back(AtHeight(middle + radius * Vector2d(turn.cos, turn.sin),
                           down < 1 ? top + down * (options.floor - top) : options.floor));
  }
  return way;
}

/// How far the tip may go from a place along a direction, mm.
double RoomAlong(const RoughRoom& room, const Vector2d& from, const Vector2d& direction, double most) {
  constexpr int kSteps = 32;
  for (int i = 1; i <= kSteps; ++i)
    if (!room.Allows(from, from + most * i / kSteps * direction, 0)) return most * (i - 1) / kSteps;
  return most;
}

std::vector<Vector3d> Ramp(const RoughRoom& room, const RoughLayerOptions& options, const Vector2d& place,
                           double top) {
  const double diameter = 2 * options.cutter.radius;
  Vector2d from = place, to = place;
  for (int i = 0; i < kRampDirections; ++i) {
    const SineCosine turn = SinCos(kPi * i / kRampDirections);
    const Vector2d direction(turn.cos, turn.sin);
    const Vector2d ahead = place + RoomAlong(room, place, direction, diameter) * direction;
    const Vector2d behind = place - RoomAlong(room, place, -direction, diameter) * direction;
    if ((ahead - behind).norm() > (to - from).norm() + 1e-9) from = behind, to = ahead;
  }
  const double length = (to - from).norm();
  if (length < (options.centre_cutting ? 0.25 : 1) * diameter) return {};
  const auto legs =
      std::max(1, static_cast<int>(std::ceil((top - options.floor) / (length * SlopeOf(options.ramp)))));
  std::vector<Vector3d> way{AtHeight(from, top)};
  for (int leg = 1; leg <= legs + 1; ++leg)
    way.push_back(
        AtHeight(leg % 2 == 1 ? to : from,
                 leg < legs ? top + static_cast<double>(leg) / legs * (options.floor - top) : options.floor));
  return way;
}

}  // namespace

std::vector<Vector3d> RoughEntry(const RoughRoom& room, const RoughLayerOptions& options,
                                 const Vector2d& place, double most_room, double disc, double top) {
  const double radius = std::min(kWidest * disc, most_room);
  if (radius >= kTightest * disc) return Helix(options, place, radius, top);
  return Ramp(room, options, place, top);
}

}  // namespace millpose
