// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "toolpath/cam/apt_scanner.hpp"

namespace millpose {

/// NX's NURBS with the KNOT, CNTRL and WEIGHT statements behind it: a rational B-spline that the tool
/// follows. Its degree follows from the counts (knots − control points − 1); the first number of NURBS must
/// be it or the order, further ones the count of knots or of control points.
class AptNurbs {
 public:
  static bool IsPart(const std::string& major) {
    return major == "KNOT" || major == "CNTRL" || major == "WEIGHT";
  }

  /// The NURBS statement.
  explicit AptNurbs(const AptStatement& statement);
  /// KNOT/u,…; CNTRL/x,y,z[,w]; WEIGHT/w,…. Throws InputError.
  void Add(const AptStatement& statement);

  /// The control points in file coordinates, in order. Throws InputError where counts, knots or weights do
  /// not make a curve.
  const std::vector<Eigen::Vector3d>& Check();
  /// Points after the curve's start up to and with its end, for control points as they lie in the part (mm);
  /// chords deviate by at most `tolerance`. Throws InputError when they become more than 1,000,000.
  std::vector<Eigen::Vector3d> Points(const std::vector<Eigen::Vector3d>& control, double tolerance) const;
  /// Start of the curve through such control points.
  Eigen::Vector3d Start(const std::vector<Eigen::Vector3d>& control) const;
  const SourceLocation& place() const { return place_; }

 private:
  using Homogeneous = Eigen::Vector4d;  // w·(x, y, z), w
  std::vector<Homogeneous> Bezier(const std::vector<Homogeneous>& control, size_t span) const;

  SourceLocation place_;
  std::vector<double> header_, knots_, weights_;
  std::vector<Eigen::Vector3d> control_;
  size_t degree_ = 0;
};

}  // namespace millpose
