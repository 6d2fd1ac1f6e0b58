// SPDX-License-Identifier: GPL-3.0-or-later
// Between the angles a controller shows (A) and the inner angles of the formula at Arm (q).
#pragma once

#include "base/trig.hpp"
#include "base/units.hpp"
#include "machine/robot/arm.hpp"

namespace millpose {

/// Inner angles q_i = sign_i·A_i + offset_i, rad.
inline Joints InnerAngles(const Arm& arm, const Joints& A) {
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = arm.sign[i] * A[i] + arm.offset[i];
  return q;
}

/// `angle` less full revolutions, in (−π, π]; an angle that lies there already stays as it is. |angle| < 1e9.
[[gnu::always_inline]] inline double Principal(double angle) {
  constexpr double kRound = 0x1.8p52;  // adding it rounds to a whole number
  const double turns = (angle * (0.5 / kPi) + kRound) - kRound;
  const double turned = angle - turns * (2 * kPi);
  const double lifted = turned <= -kPi ? turned + 2 * kPi : turned;
  return lifted > kPi ? lifted - 2 * kPi : lifted;
}

/// The inverse of InnerAngles, each angle principal.
Joints OuterAngles(const Arm& arm, const Joints& q);

/// `q` moved by whole turns to where each joint is nearest to `near`; exact where none is needed.
Joints NearestEquivalent(const Joints& near, const Joints& q);

/// Where the wrist centre lies in the plane of the arm, and the angle that decides elbow and reach.
struct ArmPlane {
  double radius;      ///< of the wrist centre in front of axis 1, mm; negative when it is behind
  SineCosine second;  ///< of q2
  SineCosine sum;     ///< of q2 + q3
  double elbow_sine;  ///< of q3 − atan2(dz, d4): 0 when upper arm and forearm are in one line
};
/// `q`: inner angles, rad.
ArmPlane PlaneOf(const Arm& arm, const Joints& q);

}  // namespace millpose
