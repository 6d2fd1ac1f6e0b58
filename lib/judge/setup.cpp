// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/setup.hpp"

#include "base/trig.hpp"

namespace millpose::audit {

Matrix4 Turn(int axis, Real angle) {
  Matrix4 X = Matrix4::Identity();
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const SineCosine turn = SinCos(static_cast<double>(angle));
  X(i, i) = X(j, j) = turn.cos;
  X(j, i) = turn.sin;
  X(i, j) = -turn.sin;
  return X;
}

Matrix4 Shift(Real x, Real y, Real z) {
  Matrix4 X = Matrix4::Identity();
  X(0, 3) = x;
  X(1, 3) = y;
  X(2, 3) = z;
  return X;
}

Matrix4 FrameXyzAbc(Real x, Real y, Real z, Real a_deg, Real b_deg, Real c_deg) {
  return Shift(x, y, z) * Turn(2, a_deg * kDegree) * Turn(1, b_deg * kDegree) * Turn(0, c_deg * kDegree);
}

std::array<Matrix4, 7> Frames(const Setup& s, const Angles& angles) {
  Angles q;
  for (size_t i = 0; i < 6; ++i) q[i] = s.sign[i] * angles[i] + s.offset[i];
  std::array<Matrix4, 7> frame;
  frame[0] = s.X_WB;
  frame[1] = frame[0] * Shift(0, 0, s.d1) * Turn(2, q[0]);
  frame[2] = frame[1] * Shift(s.a1, s.dy, 0) * Turn(1, q[1]);
  frame[3] = frame[2] * Shift(s.a2, 0, 0) * Turn(1, q[2]);
  // With parallel axes the forearm's x, about which joint 4 turns, points along axis 3.
  const Matrix4 last = frame[3] * Shift(s.d4, 0, s.dz);
  frame[4] = (s.parallel ? Matrix4(last * Turn(2, 90 * kDegree)) : last) * Turn(0, q[3]);
  frame[5] = frame[4] * Shift(0, -s.d5, 0) * Turn(1, q[4]);
  frame[6] = frame[5] * Turn(0, q[5]) * Shift(s.d6, 0, 0) * Turn(1, 90 * kDegree);
  return frame;
}

}  // namespace millpose::audit
