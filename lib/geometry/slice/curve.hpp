// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace millpose {

/// A part of a curve that lies in one face of a mesh: a straight line or an arc of an ellipse,
/// centre + cos φ · u + sin φ · v with u and v conjugate half-axes. Parameter t = 0..1 from start to end.
struct CurvePiece {
  int face = -1;
  int other_face = -1;         ///< when the piece lies on an edge: the face on the other side, else -1
  Eigen::Vector3d start, end;  ///< mm
  bool arc = false;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), u = Eigen::Vector3d::Zero(), v = Eigen::Vector3d::Zero();
  double angle0 = 0, angle1 = 0;  ///< of φ at start and end, rad; the smaller may be the end's

  Eigen::Vector3d At(double t) const;
  /// Unit direction of travel at t.
  Eigen::Vector3d Direction(double t) const;
  /// An upper bound of the length between two parameters (exact for lines), mm.
  double LengthBound(double t0, double t1) const;
  /// The part between two parameters, t0 < t1.
  CurvePiece Part(double t0, double t1) const;
  CurvePiece Reversed() const;
};

/// Pieces end to end. Of a closed curve the last piece ends where the first starts.
struct Curve {
  std::vector<CurvePiece> pieces;
  bool closed = false;
};

Curve Reversed(const Curve& curve);

/// The straight piece from a to b on a face.
CurvePiece LinePiece(int face, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace millpose
