// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/joint_law.hpp"

#include <cassert>

#include "base/trig.hpp"

namespace millpose {
namespace {

Eigen::Index Row(int joint) { return joint - 1; }

}  // namespace

Joints JointLaw::At(const Joints& q) const {
  Joints angles = q;
  for (const JointHarmonic& wave : harmonics)
    angles[Row(wave.joint)] += wave.amplitude * SinCos(wave.harmonic * q[Row(wave.joint)] + wave.phase).sin;
  for (const JointCoupling& pair : couplings) angles[Row(pair.joint)] += pair.factor * q[Row(pair.follows)];
  return angles;
}

Matrix6 JointLaw::Slope(const Joints& q) const {
  Matrix6 slope = Matrix6::Identity();
  for (const JointHarmonic& wave : harmonics) {
    const Eigen::Index i = Row(wave.joint);
    slope(i, i) += wave.amplitude * wave.harmonic * SinCos(wave.harmonic * q[i] + wave.phase).cos;
  }
  for (const JointCoupling& pair : couplings) slope(Row(pair.joint), Row(pair.follows)) += pair.factor;
  return slope;
}

Matrix6 JointLaw::LargestSlopes() const {
  Matrix6 largest = Matrix6::Zero();
  for (const JointHarmonic& wave : harmonics)
    largest(Row(wave.joint), Row(wave.joint)) += std::abs(wave.amplitude * wave.harmonic);
  for (const JointCoupling& pair : couplings)
    largest(Row(pair.joint), Row(pair.follows)) += std::abs(pair.factor);
  return largest;
}

double JointLaw::SteepestSlope() const { return LargestSlopes().rowwise().sum().maxCoeff(); }

Joints JointLaw::MostTurn(const Joints& turn) const {
  return IsNone() ? turn : Joints(turn + LargestSlopes() * turn);
}

Joints JointLaw::Invert(const Joints& angles) const {
  assert(SteepestSlope() < kSteepest);
  constexpr int kMost = 40;  // 0.23^40 is less than the last bit
  constexpr double kExact = 4e-16;
  if (IsNone()) return angles;
  Joints q = angles;
  for (int step = 0; step < kMost; ++step) {
    const Joints off = At(q) - angles;
    const Joints way = Slope(q).partialPivLu().solve(off);
    q -= way;
    if (way.cwiseAbs().maxCoeff() <= kExact * (1 + angles.cwiseAbs().maxCoeff())) break;
  }
  return q;
}

}  // namespace millpose
