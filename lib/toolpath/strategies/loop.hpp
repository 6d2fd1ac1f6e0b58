// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/slice/curve.hpp"

namespace millpose {

/// A closed curve of straight pieces with lengths along it (mm).
class Loop {
 public:
  explicit Loop(Curve curve);

  const Curve& curve() const { return curve_; }
  double length() const { return begins_.back(); }

  /// Distance of p from the line and where along it the nearest point lies; of points that are as near to
  /// 1e-7 mm the first.
  std::pair<double, double> Nearest(const Eigen::Vector3d& p) const;
  /// The way that begins at a length and goes on for `ahead` (at most the whole length), over the loop's
  /// start where needed.
  std::vector<CurvePiece> Way(double from, double ahead) const;
  /// The point at a length.
  Eigen::Vector3d At(double length) const;

 private:
  void AppendPart(double from, double to, std::vector<CurvePiece>& way) const;

  Curve curve_;
  std::vector<double> begins_{0.0};
};

/// Appends pieces to a curve, with a straight piece between where they do not touch.
void Append(Curve& curve, const std::vector<CurvePiece>& pieces);

}  // namespace millpose
