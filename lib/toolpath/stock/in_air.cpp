// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/stock/in_air.hpp"

#include <algorithm>
#include <numbers>

namespace millpose {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

namespace {

constexpr double kNothing = 0.05;    // mm: what is thinner is not cut
constexpr double kTurn = 0.25;       // of the spacing: as stocks are milled
constexpr double kChords = 0.01;     // of the spacing, likewise
constexpr double kLeastBody = 1e-3;  // mm: a cutter shrinks to no less

CutterShape Offset(const CutterShape& cutter, double by) {
  return {std::max(cutter.radius + by, kLeastBody), std::max(cutter.corner_radius + by, 0.0),
          std::max(cutter.length + 2 * by, kLeastBody)};
}

/// Whether a volume meets the box, which is exact where the box is a piece of a line along `along`.
bool MayMeet(const SweptVolume& volume, const AlignedBox3d& box, int along) {
  if (!volume.box().intersects(box)) return false;
  const Vector3d size = box.sizes();
  if (size[(along + 1) % 3] > 0 || size[(along + 2) % 3] > 0) return true;
  Vector3d origin = box.min();
  origin[along] = 0;
  const auto met = volume.On(origin, Vector3d::Unit(along));
  return met && met->low < box.max()[along] && met->high > box.min()[along];
}

}  // namespace

AirCheck::Grown::Grown(const CutterShape& cutter, double offset, double spacing)
    : profile(Offset(cutter, offset), kChords * spacing), by(offset), turn(kTurn * spacing) {}

bool AirCheck::Grown::Meets(const CutterMotion& motion, const StandingStock& stock) const {
  for (const CutterMotion& part : WithoutTurns(motion, profile.length, turn)) {
    const Vector3d down = -by * part.from.axis;
    const SweptVolume volume(profile, part.from.tip + down, part.to.tip + down, part.from.axis);
    if (stock.Meets([&](const AlignedBox3d& box) { return MayMeet(volume, box, stock.along()); }))
      return true;
  }
  return false;
}

AirCheck::AirCheck(const CutterShape& cutter, double margin, double spacing)
    : cut_(cutter, -kNothing, spacing),
      near_(cutter, margin + (std::numbers::sqrt2 + kTurn + kChords) * spacing, spacing) {}

InAir AirCheck::Of(const CutterMotion& motion, const StandingStock& stock) const {
  if (!near_.Meets(motion, stock)) return InAir::kClear;
  return cut_.Meets(motion, stock) ? InAir::kCuts : InAir::kTouches;
}

}  // namespace millpose
