// SPDX-License-Identifier: GPL-3.0-or-later
#include "audit/setup.hpp"

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

namespace {

/// By an angle about a line, from the half-angle's products: (1 − cos) = 2·sin², sin = 2·sin·cos.
Matrix4 TurnAbout(const Vector3& line, const Vector3& place, Real angle) {
  const SineCosine half = SinCos(static_cast<double>(angle / 2));
  const Real s = half.sin, c = half.cos;
  Matrix4 X = Matrix4::Identity();
  for (int i = 0; i < 3; ++i) {
    const Vector3 e = Vector3::Unit(i);
    const Vector3 across = line.cross(e);
    X.block<3, 1>(0, i) = e + 2 * s * c * across + 2 * s * s * line.cross(across);
  }
  X.block<3, 1>(0, 3) = place - Vector3(X.block<3, 3>(0, 0) * place);
  return X;
}

}  // namespace

Matrix4 Carried(const Setup& setup, int last, const std::vector<Real>& position) {
  Matrix4 X = Matrix4::Identity();
  for (int i = 0; i <= last; ++i) {
    const ExternalAxis& axis = setup.axes[static_cast<size_t>(i)];
    if (axis.carries_robot != setup.axes[static_cast<size_t>(last)].carries_robot) continue;
    const Real value = position[static_cast<size_t>(i)];
    const Vector3 way = value * axis.direction;
    X *= axis.rotary ? TurnAbout(axis.direction, axis.origin, value) : Shift(way[0], way[1], way[2]);
  }
  return X;
}

int LastCarrier(const Setup& setup, bool robot) {
  for (int i = static_cast<int>(setup.axes.size()) - 1; i >= 0; --i)
    if (setup.axes[static_cast<size_t>(i)].carries_robot == robot) return i;
  return -1;
}

Setup At(const Setup& setup, const std::vector<Real>& position) {
  Setup at = setup;
  if (position.empty()) return at;
  at.X_WB = Carried(setup, LastCarrier(setup, true), position) * setup.X_WB;
  at.X_WP = Carried(setup, LastCarrier(setup, false), position) * setup.X_WP;
  for (Body& body : at.bodies)
    if (body.link < 0) body.X_LG = Carried(setup, body.carrier, position) * body.X_LG;
  for (size_t i = 0; i < setup.axes.size(); ++i) {
    const ExternalAxis& axis = setup.axes[i];
    if (axis.compliance == 0) continue;
    // The line stands where the axis itself has come to: its own value moves it along or about itself.
    const Matrix4 X = at.X_WB.inverse() * Carried(setup, static_cast<int>(i), position);
    const Vector3 along = X.block<3, 3>(0, 0) * axis.direction;
    const Vector3 place = X.block<3, 3>(0, 0) * axis.origin + X.block<3, 1>(0, 3);
    Spring spring{0, Shift(place[0], place[1], place[2]), {}};
    spring.C.setZero();
    const Eigen::Index block = axis.rotary ? 3 : 0;
    spring.C.block<3, 3>(block, block) = axis.compliance * along * along.transpose();
    at.springs.push_back(spring);
  }
  at.axes.clear();
  return at;
}

std::array<Matrix4, 7> Frames(const Setup& s, const Angles& angles) {
  Angles own = angles;
  for (const Setup::Wave& wave : s.waves)
    own[wave.joint] +=
        wave.amplitude * SinCos(static_cast<double>(wave.count * angles[wave.joint] + wave.phase)).sin;
  for (const Setup::Follower& one : s.followers) own[one.joint] += one.factor * angles[one.by];
  Angles q;
  for (size_t i = 0; i < 6; ++i) q[i] = s.sign[i] * own[i] + s.offset[i];
  std::array<Matrix4, 7> frame;
  const std::array<Matrix4, 7>& off = s.deviations;
  frame[0] = s.X_WB * off[0];
  frame[1] = frame[0] * Shift(0, 0, s.d1) * Turn(2, q[0]) * off[1];
  frame[2] = frame[1] * Shift(s.a1, s.dy, 0) * Turn(1, q[1]) * off[2];
  frame[3] = frame[2] * Shift(s.a2, 0, 0) * Turn(1, q[2]) * off[3];
  // With parallel axes the forearm's x, about which joint 4 turns, points along axis 3.
  const Matrix4 last = frame[3] * Shift(s.d4, 0, s.dz);
  frame[4] = (s.parallel ? Matrix4(last * Turn(2, 90 * kDegree)) : last) * Turn(0, q[3]) * off[4];
  frame[5] = frame[4] * Shift(0, -s.d5, 0) * Turn(1, q[4]) * off[5];
  frame[6] = frame[5] * Turn(0, q[5]) * Shift(s.d6, 0, 0) * Turn(1, 90 * kDegree) * off[6];
  return frame;
}

}  // namespace millpose::audit
