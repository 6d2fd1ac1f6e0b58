// SPDX-License-Identifier: GPL-3.0-or-later
// Where a line runs through what a cutter sweeps on a straight motion (docs/stock.md).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "toolpath/stock/swept_cutter.hpp"

namespace millpose {

/// From `low` to `high` along a line, mm.
struct Span {
  double low = 0, high = 0;
};

/// A cutter as frusta about its axis, one on the other from the tip to the end of the cutting length. The
/// corner's arc becomes chords: nowhere is the profile wider than the cutter, nor narrower by more than
/// `tolerance` (mm).
struct CutterProfile {
  struct Frustum {
    double low, high;     ///< along the axis from the tip, mm
    double radius, rise;  ///< radius(h) = radius + rise · h, mm
  };
  std::vector<Frustum> frusta;
  double radius = 0, length = 0;

  CutterProfile(const CutterShape& cutter, double tolerance);
};

/// The volume that a cutter sweeps while its tip goes straight from one place to another and its axis keeps
/// its direction. It is convex, so a line meets it in one span.
class SweptVolume {
 public:
  SweptVolume(const CutterProfile& profile, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
              const Eigen::Vector3d& axis);

  /// Where origin + t · direction (unit) is inside, in t; exact to 1e-9 mm for the profile.
  std::optional<Span> On(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  /// Where a line runs between the planes across the cutter at its tip and where its cutting length ends, in
  /// t: On is within it and costs far more.
  Span BetweenPlanes(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  const Eigen::AlignedBox3d& box() const { return box_; }

 private:
  bool PassesBeside(const Eigen::Vector3d& beyond, const Eigen::Vector3d& direction) const;

  const CutterProfile& profile_;
  Eigen::Vector3d from_, way_, axis_;
  Eigen::AlignedBox3d box_;
};

/// A motion whose axis may turn as motions whose axes do not: no point of the cutter is then farther from
/// where it was than `tolerance`, mm.
std::vector<CutterMotion> WithoutTurns(const CutterMotion& motion, double length, double tolerance);

}  // namespace millpose
