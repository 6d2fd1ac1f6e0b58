// SPDX-License-Identifier: GPL-3.0-or-later
// A share of a laid tool path: what a part is milled of from one of several stations.
#pragma once

#include <limits>
#include <vector>

#include "geometry/slice/curve.hpp"

namespace millpose {

/// What lies between two planes across a direction. Frame P, mm.
struct PathSection {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit vector
  double from = -std::numeric_limits<double>::infinity();
  double to = std::numeric_limits<double>::infinity();
  double overlap = 0;  ///< passes run on by half of it beyond both planes

  /// Between which values along the direction passes lie.
  double Least() const { return from - overlap / 2; }
  double Most() const { return to + overlap / 2; }
  /// Whether what is milled as a whole (a hole at p) belongs to this share: of shares that meet, to one.
  bool Owns(const Eigen::Vector3d& p) const { return direction.dot(p) >= from && direction.dot(p) < to; }
};

/// The parts of a curve between the planes, cut where it crosses them. Parts not longer than `least_length`
/// (mm) are dropped. A closed curve that is cut nowhere stays closed.
std::vector<Curve> ClipToSection(const Curve& curve, const PathSection& share, double least_length);

/// Between which values along a direction a curve lies.
std::pair<double, double> ExtentOf(const Curve& curve, const Eigen::Vector3d& direction);

}  // namespace millpose
