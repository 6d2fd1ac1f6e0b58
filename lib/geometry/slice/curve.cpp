// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/slice/curve.hpp"

#include "base/trig.hpp"

namespace millpose {

Eigen::Vector3d CurvePiece::At(double t) const {
  if (t <= 0) return start;
  if (t >= 1) return end;
  if (!arc) return start + t * (end - start);
  const SineCosine turn = SinCos(angle0 + t * (angle1 - angle0));
  return centre + turn.cos * u + turn.sin * v;
}

Eigen::Vector3d CurvePiece::Direction(double t) const {
  if (!arc) return (end - start).normalized();
  const SineCosine turn = SinCos(angle0 + t * (angle1 - angle0));
  const Eigen::Vector3d turning = turn.cos * v - turn.sin * u;
  return (angle1 < angle0 ? Eigen::Vector3d(-turning) : turning).normalized();
}

double CurvePiece::LengthBound(double t0, double t1) const {
  if (!arc) return (t1 - t0) * (end - start).norm();
  // |d/dφ|² ≤ |u|² + |v|² by Cauchy and Schwarz.
  return (t1 - t0) * std::abs(angle1 - angle0) * std::sqrt(u.squaredNorm() + v.squaredNorm());
}

CurvePiece CurvePiece::Part(double t0, double t1) const {
  CurvePiece part = *this;
  part.start = At(t0);
  part.end = At(t1);
  part.angle0 = angle0 + t0 * (angle1 - angle0);
  part.angle1 = angle0 + t1 * (angle1 - angle0);
  return part;
}

CurvePiece CurvePiece::Reversed() const {
  CurvePiece reversed = *this;
  std::swap(reversed.start, reversed.end);
  std::swap(reversed.angle0, reversed.angle1);
  return reversed;
}

Curve Reversed(const Curve& curve) {
  Curve reversed;
  reversed.closed = curve.closed;
  for (auto it = curve.pieces.rbegin(); it != curve.pieces.rend(); ++it)
    reversed.pieces.push_back(it->Reversed());
  return reversed;
}

CurvePiece LinePiece(int face, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  CurvePiece piece;
  piece.face = face;
  piece.start = a;
  piece.end = b;
  return piece;
}

}  // namespace millpose
