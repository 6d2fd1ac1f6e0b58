// SPDX-License-Identifier: GPL-3.0-or-later
// Three numbers and a symmetric 3×3 matrix whose operations always inline, for loops over lanes. Internal.
#pragma once

#include <cmath>

namespace millpose::small {

struct Vec {
  double x, y, z;
};
[[gnu::always_inline]] inline Vec operator+(const Vec& a, const Vec& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[gnu::always_inline]] inline Vec operator-(const Vec& a, const Vec& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[gnu::always_inline]] inline Vec operator*(double s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
[[gnu::always_inline]] inline double Dot(const Vec& a, const Vec& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[gnu::always_inline]] inline Vec Cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

struct Symmetric {
  double xx, yy, zz, xy, xz, yz;
};
[[gnu::always_inline]] inline Vec operator*(const Symmetric& m, const Vec& v) {
  return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
          m.xz * v.x + m.yz * v.y + m.zz * v.z};
}
[[gnu::always_inline]] inline Symmetric Adjugate(const Symmetric& m) {
  return {m.yy * m.zz - m.yz * m.yz, m.xx * m.zz - m.xz * m.xz, m.xx * m.yy - m.xy * m.xy,
          m.xz * m.yz - m.xy * m.zz, m.xy * m.yz - m.xz * m.yy, m.xy * m.xz - m.yz * m.xx};
}
[[gnu::always_inline]] inline double Determinant(const Symmetric& m, const Symmetric& adjugate) {
  return m.xx * adjugate.xx + m.xy * adjugate.xy + m.xz * adjugate.xz;
}

/// Larger eigenvalue of [a c; c b].
[[gnu::always_inline]] inline double LargerEigenvalue(double a, double b, double c) {
  const double half = 0.5 * (a - b);
  return 0.5 * (a + b) + std::sqrt(half * half + c * c);
}

}  // namespace millpose::small
